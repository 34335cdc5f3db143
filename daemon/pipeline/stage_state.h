// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "pipeline/fault.h"

namespace dts::pipeline {

/// Fills the numbers of a stage's state one after the other; what does not fit is left out. Realtime-safe: yes.
class StateWriter {
 public:
  explicit StateWriter(std::span<double> state) noexcept : state_(state) {}

  void put(double value) noexcept {
    if (next_ < state_.size()) state_[next_++] = value;
  }
  void put_count(std::uint64_t value) noexcept { put(static_cast<double>(value)); }

 private:
  std::span<double> state_;
  std::size_t next_ = 0;
};

/// Takes them again and remembers whether all were possible: they come from a file. A number that was not possible reads as 0.
class StateReader {
 public:
  /// `expected` numbers, or nothing is right.
  StateReader(std::span<const double> state, std::size_t expected) noexcept : state_(state), is_right_(state.size() == expected) {}

  [[nodiscard]] bool is_right() const noexcept { return is_right_; }

  /// Anything, also NaN.
  double any() noexcept { return next_ < state_.size() && is_right_ ? state_[next_++] : 0.0; }
  /// In [minimum, maximum]; NaN is not.
  double number(double minimum, double maximum) noexcept {
    const double value = any();
    return accept(value >= minimum && value <= maximum) ? value : 0.0;
  }
  /// A whole number from 0 to `maximum`, which a double holds exactly.
  std::uint64_t count(std::uint64_t maximum) noexcept {
    constexpr std::uint64_t kExact = std::uint64_t{1} << 53U;
    const double value = number(0.0, static_cast<double>(maximum < kExact ? maximum : kExact));
    return accept(value == std::floor(value)) ? static_cast<std::uint64_t>(value) : 0;
  }
  bool flag() noexcept { return count(1) == 1; }
  std::uint8_t bits() noexcept { return static_cast<std::uint8_t>(count(0xFF)); }
  /// A value as a stage keeps it: not finite only with a bit that says why (see `explained`).
  void check_explained(double value, std::uint8_t bits) noexcept { accept(std::isfinite(value) || (bits & kFaultBits) != 0); }

 private:
  bool accept(bool is_fine) noexcept {
    is_right_ = is_right_ && is_fine;
    return is_right_;
  }

  std::span<const double> state_;
  std::size_t next_ = 0;
  bool is_right_;
};

}  // namespace dts::pipeline
