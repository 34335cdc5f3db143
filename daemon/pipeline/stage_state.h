// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "pipeline/fault.h"

namespace dts::pipeline {

/// Writes the values of a stage's state in sequence; values beyond the end are ignored. Realtime-safe: yes.
class StateWriter {
 public:
  explicit StateWriter(std::span<double> state) noexcept : state_(state) {}

  void put(double value) noexcept {
    if (next_ < state_.size()) state_[next_++] = value;
  }
  void put_count(std::uint64_t value) noexcept { put(static_cast<double>(value)); }
  /// Returns the next `count` values, for a part that writes them itself; fewer at the end.
  [[nodiscard]] std::span<double> take(std::size_t count) noexcept {
    const std::size_t first = next_;
    next_ += std::min(count, state_.size() - next_);
    return state_.subspan(first, next_ - first);
  }

 private:
  std::span<double> state_;
  std::size_t next_ = 0;
};

/// Reads the values again and records whether all were possible, because they come from a file. Returns 0 for an impossible value.
class StateReader {
 public:
  /// `state` is wrong if it does not have `expected` values.
  StateReader(std::span<const double> state, std::size_t expected) noexcept : state_(state), is_right_(state.size() == expected) {}

  [[nodiscard]] bool is_right() const noexcept { return is_right_; }

  /// Returns the next `count` values, for a part that checks them itself; fewer at the end.
  [[nodiscard]] std::span<const double> take(std::size_t count) noexcept {
    const std::size_t first = next_;
    next_ += std::min(count, state_.size() - next_);
    return state_.subspan(first, next_ - first);
  }
  /// Accepts any value, also NaN.
  double any() noexcept { return next_ < state_.size() && is_right_ ? state_[next_++] : 0.0; }
  /// Accepts a value in [minimum, maximum], but not NaN.
  double number(double minimum, double maximum) noexcept {
    const double value = any();
    return accept(value >= minimum && value <= maximum) ? value : 0.0;
  }
  /// Accepts a whole number from 0 to `maximum`, at most 2^53, which a double holds exactly.
  std::uint64_t count(std::uint64_t maximum) noexcept {
    constexpr std::uint64_t kExact = std::uint64_t{1} << 53U;
    const double value = number(0.0, static_cast<double>(maximum < kExact ? maximum : kExact));
    return accept(value == std::floor(value)) ? static_cast<std::uint64_t>(value) : 0;
  }
  bool flag() noexcept { return count(1) == 1; }
  std::uint8_t bits() noexcept { return static_cast<std::uint8_t>(count(0xFF)); }
  /// Accepts a value that is not finite only with a quality bit that explains it (see `explained`).
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
