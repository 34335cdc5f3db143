// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>

namespace dts::gateway {

/// Limits how often something may happen per second, with a burst: four seconds' worth by default. Has no clock: the caller passes the
/// time.
class TokenBucket {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr double kBurst_s = 4.0;

  explicit TokenBucket(double per_second) noexcept : TokenBucket(per_second, per_second * kBurst_s) {}
  TokenBucket(double per_second, double burst) noexcept : per_second_(per_second), burst_(burst), left_(burst) {}

  /// Returns false if the limit is exceeded.
  [[nodiscard]] bool take(Time now) noexcept {
    if (last_ != Time()) left_ += per_second_ * std::chrono::duration<double>(now - last_).count();
    left_ = std::min(left_, burst_);
    last_ = now;
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }

 private:
  double per_second_;
  double burst_;
  double left_;
  Time last_{};
};

}  // namespace dts::gateway
