// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "device/device.h"

namespace dts::device::usb {

/// Comparison of the beginning of a scan with single readings made just before.
struct Agreement {
  bool is_rotated = false;        ///< Rotated channels explain the scan clearly better than changed signals.
  std::size_t rotation = 0;       ///< Number of channels by which they are rotated.
  bool is_different = false;      ///< The difference is larger than noise.
  std::size_t worst_channel = 0;  ///< Channel with the largest difference.
  double worst_difference_v = 0.0;
};

/// Mean difference per channel that counts as agreement: noise, mains hum, a breathing person.
inline constexpr double kAgreementToleranceV = 0.02;

/// Compares single readings with `scan_v`, the mean of each channel over the first scans. Finds a rotation only if it fits clearly
/// better than no rotation, since a person may have moved in between. Values that are not finite: no rotation. Realtime-safe: yes.
[[nodiscard]] Agreement compare_with_single_readings(std::span<const double> single_v, std::span<const double> scan_v) noexcept;

/// Returns the comparison as a check for the report.
[[nodiscard]] DeviceCheck describe_agreement(const Agreement& agreement, const DeviceDescription& description);

}  // namespace dts::device::usb
