// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "device/usb/usb_bus.h"

namespace dts::device {

/// A plugged-in unit that this program can drive.
struct FoundUnit {
  usb::UsbUnit unit;
  std::string model;
  std::string uri;  ///< URI for a rig's configuration: "mcc:1608fs-plus?serial=01A2B3C4".
};

/// Returns all such units, used by a rig or not. Fails if the program cannot list the machine's USB devices.
[[nodiscard]] core::Result<std::vector<FoundUnit>> find_units(usb::UsbBus& bus);

/// Returns true if a device with this URI would open the unit: same model, and same serial number if the URI has one.
[[nodiscard]] bool is_meant_by(const FoundUnit& unit, const std::string& device_uri);

}  // namespace dts::device
