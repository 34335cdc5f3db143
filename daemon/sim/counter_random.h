// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "core/split_mix.h"

namespace dts::sim {

/// Random numbers by index instead of by sequence: number n of a seed is always the same. Therefore scans that nobody reads need not be
/// computed, and nothing depends on the block size. Thread: any. Realtime-safe: yes.
class CounterRandom {
 public:
  explicit CounterRandom(std::uint64_t seed) noexcept : key_(core::split_mix(seed)) {}

  [[nodiscard]] std::uint64_t bits(std::uint64_t n) const noexcept { return core::split_mix(key_ + (n + 1) * core::kGoldenGamma); }
  /// Returns a number in [0, 1).
  [[nodiscard]] double uniform(std::uint64_t n) const noexcept { return static_cast<double>(bits(n) >> 11) * kUnit; }
  /// Returns two independent values of mean 0 and standard deviation 1 (Box-Muller), from numbers 2n and 2n+1.
  [[nodiscard]] std::pair<double, double> gaussian_pair(std::uint64_t n) const noexcept {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(2 * n)));
    const double angle = 2.0 * std::numbers::pi * uniform(2 * n + 1);
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }

 private:
  static constexpr double kUnit = 0x1p-53;

  std::uint64_t key_;
};

/// Returns number n of `random`, uniformly distributed in -1 .. 1.
[[nodiscard]] inline double either_side(const CounterRandom& random, std::uint64_t n) noexcept { return 2.0 * random.uniform(n) - 1.0; }

}  // namespace dts::sim
