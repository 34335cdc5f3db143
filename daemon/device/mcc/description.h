// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "device/device.h"
#include "device/usb/daq_options.h"
#include "device/usb/usb_bus.h"

namespace dts::device::mcc {

inline constexpr std::uint16_t kVendor = 0x09DB;
inline constexpr double kMinimumScanHz = 1.0;  ///< Below this rate a broken device looks like a slow device for too long.

/// Returns every MCC product that a driver of this folder knows.
[[nodiscard]] std::vector<usb::UsbModel> all_models();

/// Returns the description of a unit that need not be plugged in: one channel per position of the scan, named by its input; the marker
/// channel has the role Marker.
[[nodiscard]] DeviceDescription describe_unit(std::string_view product, const usb::DaqOptions& options, unsigned bits, double max_scan_hz);

}  // namespace dts::device::mcc
