// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dts::lab::training {

/// Random numbers that are the same on every machine; the distributions of different standard libraries may differ. SplitMix64 (Steele,
/// Lea, Flood 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) noexcept : state_(seed) {}

  [[nodiscard]] std::uint64_t next() noexcept;
  /// Returns a number in [lowest, highest).
  [[nodiscard]] double uniform(double lowest, double highest) noexcept;
  /// Returns 0 .. count - 1; `count` must not be 0.
  [[nodiscard]] std::size_t index(std::size_t count) noexcept;
  /// Returns 0 .. count - 1 in random order.
  [[nodiscard]] std::vector<std::size_t> shuffled(std::size_t count);

 private:
  std::uint64_t state_;
};

/// Returns a separate seed for each use of one seed.
[[nodiscard]] std::uint64_t derived_seed(std::uint64_t seed, std::uint64_t use) noexcept;

}  // namespace dts::lab::training
