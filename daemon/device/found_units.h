// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "device/usb/usb_bus.h"

namespace dts::device {

/// A unit that is plugged in and that this program could drive.
struct FoundUnit {
  usb::UsbUnit unit;
  std::string model;
  std::string uri;  ///< What a rig's configuration would have to say: "mcc:1608fs-plus?serial=01A2B3C4".
};

/// All such units, whether a rig uses them or not. Fails when the machine's USB cannot be looked at.
[[nodiscard]] core::Result<std::vector<FoundUnit>> find_units(usb::UsbBus& bus);

/// A device with this URI would open the unit: its model, and its serial number when the URI names one.
[[nodiscard]] bool is_meant_by(const FoundUnit& unit, const std::string& device_uri);

}  // namespace dts::device
