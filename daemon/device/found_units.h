// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "device/bytes/usb_tty.h"
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

/// A serial port of a plugged-in USB device. Whether a board that speaks to dtsd is behind it shows only when it is opened.
struct FoundPort {
  bytes::UsbTty tty;
  std::string model;  ///< "Arduino Uno R3 (USB 2341:0043, /dev/ttyACM0)"
  std::string uri;    ///< For a rig's configuration, without the number: "serial:/dev/serial/by-id/usb-...?channels=N".
};

/// Returns the serial ports of all USB devices. `root`: see `bytes::usb_ttys`.
[[nodiscard]] std::vector<FoundPort> find_ports(const std::string& root = {});

/// Returns true if a device with this URI would open the port: by its name, its link, or its USB serial number.
[[nodiscard]] bool is_meant_by(const FoundPort& port, const std::string& device_uri);

}  // namespace dts::device
