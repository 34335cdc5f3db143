// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>

namespace dts::physics {

/// Returns random values from the generator's upper 53 bits: the same with every library.
class UniformRandom {
 public:
  explicit UniformRandom(std::uint64_t seed) : random_(seed) {}
  double operator()(double lowest, double highest) { return lowest + (highest - lowest) * static_cast<double>(random_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 random_;
};

}  // namespace dts::physics
