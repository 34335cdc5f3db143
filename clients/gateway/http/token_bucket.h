// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>

namespace dts::gateway {

/// So many happenings per second, and four seconds' worth of them at once. Told the time.
class TokenBucket {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr double kBurst_s = 4.0;

  explicit TokenBucket(double per_second) noexcept : per_second_(per_second), left_(per_second * kBurst_s) {}

  /// False: one too many.
  [[nodiscard]] bool take(Time now) noexcept {
    if (last_ != Time()) left_ += per_second_ * std::chrono::duration<double>(now - last_).count();
    left_ = std::min(left_, per_second_ * kBurst_s);
    last_ = now;
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }

 private:
  double per_second_;
  double left_;
  Time last_{};
};

}  // namespace dts::gateway
