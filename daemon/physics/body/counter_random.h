// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace dts::physics {

/// Random numbers by position instead of by sequence: number n of a seed is always the same, so that scans which nobody
/// reads need not be computed and nothing depends on the block size. This is splitmix64 (Steele, Lea, Flood 2014,
/// "Fast splittable pseudorandom number generators") entered at its n-th step. Thread: any. Realtime-safe: yes.
class CounterRandom {
 public:
  explicit CounterRandom(std::uint64_t seed) noexcept : key_(mix(seed)) {}

  [[nodiscard]] std::uint64_t bits(std::uint64_t n) const noexcept { return mix(key_ + (n + 1) * kGoldenGamma); }
  /// In [0, 1).
  [[nodiscard]] double uniform(std::uint64_t n) const noexcept { return static_cast<double>(bits(n) >> 11) * kUnit; }
  /// Two independent values of mean 0 and deviation 1 (Box-Muller), from numbers 2n and 2n+1.
  [[nodiscard]] std::pair<double, double> gaussian_pair(std::uint64_t n) const noexcept {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(2 * n)));
    const double angle = 2.0 * std::numbers::pi * uniform(2 * n + 1);
    return {radius * std::cos(angle), radius * std::sin(angle)};
  }

 private:
  static constexpr std::uint64_t kGoldenGamma = 0x9e3779b97f4a7c15ULL;
  static constexpr double kUnit = 0x1p-53;

  static std::uint64_t mix(std::uint64_t z) noexcept {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

  std::uint64_t key_;
};

}  // namespace dts::physics
