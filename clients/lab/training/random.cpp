// SPDX-License-Identifier: Apache-2.0
#include "lab/training/random.h"

#include <numeric>
#include <utility>

namespace dts::lab::training {

std::uint64_t Random::next() noexcept {
  state_ += 0x9E3779B97F4A7C15U;
  std::uint64_t mixed = state_;
  mixed = (mixed ^ (mixed >> 30U)) * 0xBF58476D1CE4E5B9U;
  mixed = (mixed ^ (mixed >> 27U)) * 0x94D049BB133111EBU;
  return mixed ^ (mixed >> 31U);
}

double Random::uniform(double lowest, double highest) noexcept {
  constexpr double kStep = 0x1.0p-53;
  return lowest + (highest - lowest) * static_cast<double>(next() >> 11U) * kStep;
}

std::size_t Random::index(std::size_t count) noexcept { return static_cast<std::size_t>(next() % count); }

std::vector<std::size_t> Random::shuffled(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t k = count; k > 1; --k) std::swap(order[k - 1], order[index(k)]);
  return order;
}

std::uint64_t derived_seed(std::uint64_t seed, std::uint64_t use) noexcept { return Random(Random(seed).next() ^ use).next(); }

}  // namespace dts::lab::training
