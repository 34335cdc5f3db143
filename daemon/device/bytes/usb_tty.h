// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dts::device::bytes {

/// A serial port of a USB device, as sysfs shows it.
struct UsbTty {
  std::string name;  ///< "ttyACM0"
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string manufacturer;  ///< Text of the device, printable; may be empty.
  std::string product_name;  ///< Text of the device, printable; may be empty.
  std::string serial;        ///< USB serial number, printable; empty: the device has none (most CH340).
  std::string by_id;         ///< "/dev/serial/by-id/usb-..."; empty: udev has made no such link.

  /// Returns the device file: "/dev/ttyACM0".
  [[nodiscard]] std::string node() const { return "/dev/" + name; }
};

/// Returns the serial ports of USB devices, in the order of their names. Ports of the PC (ttyS0) and terminals are not among them.
/// `root`: folder that holds sys/ and dev/; empty: the machine's own.
[[nodiscard]] std::vector<UsbTty> usb_ttys(const std::string& root = {});

/// Returns the name of a well-known board or adapter: "Arduino Uno"; empty: its own product name must do.
[[nodiscard]] std::string_view known_board(std::uint16_t vendor, std::uint16_t product) noexcept;

}  // namespace dts::device::bytes
