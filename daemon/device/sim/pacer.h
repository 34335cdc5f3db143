// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/rate.h"

namespace dts::device::sim {

/// Host times of the scans of a device's clock. Scan i is at start + i / rate * (1 - ppm * 1e-6); with a positive error the clock
/// runs fast. Thread: any. Realtime-safe: yes.
class Pacer {
 public:
  Pacer() = default;
  Pacer(std::int64_t start_ns, core::Rate rate, double clock_error_ppm) noexcept
      : start_ns_(start_ns), rate_(rate), clock_error_(clock_error_ppm * 1e-6) {}

  [[nodiscard]] core::Rate rate() const noexcept { return rate_; }
  /// Returns the host time at which a scan is sampled.
  [[nodiscard]] std::int64_t instant_ns(std::uint64_t scan) const noexcept;
  /// Returns the number of scans that are sampled by `now_ns`.
  [[nodiscard]] std::uint64_t taken_by(std::int64_t now_ns) const noexcept;
  /// Returns the time of the device's clock since start at host time `host_ns`; negative before the start.
  [[nodiscard]] double device_time_s(std::int64_t host_ns) const noexcept {
    return static_cast<double>(host_ns - start_ns_) * 1e-9 / (1.0 - clock_error_);
  }

 private:
  std::int64_t start_ns_ = 0;
  core::Rate rate_;
  double clock_error_ = 0.0;
};

}  // namespace dts::device::sim
