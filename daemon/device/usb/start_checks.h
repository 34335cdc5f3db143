// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "device/device.h"

namespace dts::device::usb {

/// How the beginning of a scan compares with single readings taken just before.
struct Agreement {
  bool is_rotated = false;        ///< Shifting the channels explains the scan, a change of the signals does not.
  std::size_t rotation = 0;       ///< By so many channels.
  bool is_different = false;      ///< More than noise.
  std::size_t worst_channel = 0;  ///< Where the two differ most, and by how much.
  double worst_difference_v = 0.0;
};

/// Below this, on average per channel, nothing is looked for: noise, mains hum, a person who breathes.
inline constexpr double kAgreementToleranceV = 0.02;

/// `scan_v`: mean of each channel over the first scans. A rotation is only believed when it fits clearly better than the scan as
/// it is: somebody may have moved between the two. Values that are not finite: no rotation. Realtime-safe: yes.
[[nodiscard]] Agreement compare_with_single_readings(std::span<const double> single_v, std::span<const double> scan_v) noexcept;

/// The same for a report.
[[nodiscard]] DeviceCheck describe_agreement(const Agreement& agreement, const DeviceDescription& description);

}  // namespace dts::device::usb
