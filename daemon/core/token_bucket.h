// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>

namespace dts::core {

/// Limits how often something may happen: `per_second` in the long run, `burst` at once after a pause. Has no clock: the caller passes the
/// time. A time before the last one counts as the last one. Thread: one.
class TokenBucket {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// `burst`: four seconds' worth.
  explicit TokenBucket(double per_second) noexcept : TokenBucket(per_second, 4.0 * per_second) {}
  TokenBucket(double per_second, double burst) noexcept : per_second_(per_second), burst_(burst), left_(burst) {}

  /// Returns true, and counts the event, if one more event is allowed now. `weight`: it counts as so many, at most as a burst.
  [[nodiscard]] bool take(Time now, double weight = 1.0) noexcept {
    weight = std::min(weight, burst_);
    left_ = left(now);
    last_ = std::max(last_, now);
    if (left_ < weight) return false;
    left_ -= weight;
    return true;
  }
  /// Counts what has happened already, as `weight` events, also if so many were not allowed: the next ones then wait longer.
  void spend(Time now, double weight) noexcept {
    left_ = left(now) - weight;
    last_ = std::max(last_, now);
  }
  /// Returns true if one more event is allowed now, and does not count it.
  [[nodiscard]] bool has_one(Time now) const noexcept { return left(now) >= 1.0; }
  /// Returns true if a whole burst is allowed now.
  [[nodiscard]] bool is_full(Time now) const noexcept { return left(now) >= burst_; }

 private:
  [[nodiscard]] double left(Time now) const noexcept {
    const std::chrono::duration<double> pause = now - last_;
    return std::min(burst_, left_ + std::max(0.0, pause.count()) * per_second_);
  }

  double per_second_;
  double burst_;
  double left_;
  Time last_{};
};

}  // namespace dts::core
