// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

#include "core/host_time.h"
#include "core/rate.h"

namespace dts::test {

inline constexpr std::int64_t kFirstScanNs = 5'000'000'000'000;
inline constexpr std::int64_t kMillisecond = 1'000'000;

/// A device with a clock that is off, and a machine with two busy cores that notices its scans late.
struct Machine {
  core::Rate rate;
  double clock_error = 0.0;  ///< 80e-6: the device's clock runs 80 ppm fast.
  std::size_t scans_per_transfer = 30;
  double busy_ms = 4.0;           ///< What a transfer waits for a time slice, in the mean ...
  unsigned waiting_percent = 50;  ///< ... and how many have to.
  std::mt19937_64 random{7};
  std::uint64_t next = 0;  ///< As the host counts.
  std::uint64_t lost = 0;  ///< Scans that the device has taken and the host never saw.
  std::int64_t last_arrival_ns = 0;

  [[nodiscard]] std::int64_t truth_ns(std::uint64_t scan) const {
    return kFirstScanNs + std::llround(static_cast<double>(rate.time_ns({scan + lost})) / (1.0 + clock_error));
  }

  /// Some of the transfers wait for a time slice; now and then something blocks for 80 ms.
  std::int64_t lateness_ns() {
    std::exponential_distribution<double> wait_ms(1.0 / busy_ms);
    const auto kind = random() % 100;
    const double late_ms =
        0.15 + (kind >= waiting_percent ? 0.05 * static_cast<double>(random() % 10) : wait_ms(random)) + (kind == 0 ? 80.0 : 0.0);
    return std::llround(late_ms * 1e6);
  }

  /// One transfer.
  void step(core::HostTime& time) {
    const std::uint64_t newest = next + scans_per_transfer - 1;
    last_arrival_ns = std::max(last_arrival_ns, truth_ns(newest) + lateness_ns());
    time.add({newest}, last_arrival_ns);
    next += scans_per_transfer;
  }

  void run(core::HostTime& time, double seconds) {
    const auto until = next + static_cast<std::uint64_t>(seconds * rate.hz());
    while (next < until) step(time);
  }

  [[nodiscard]] double error_ms(core::HostTime& time) const { return static_cast<double>(time.at({next - 1}) - truth_ns(next - 1)) * 1e-6; }
};

}  // namespace dts::test
