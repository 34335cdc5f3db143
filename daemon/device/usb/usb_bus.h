// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "device/usb/usb_port.h"

namespace dts::device::usb {

/// A product that a driver knows.
struct UsbModel {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string_view name;  ///< "USB-1608FS-Plus"
  std::string_view uri;   ///< Its URI: "mcc:1608fs-plus".
};

/// The machine's USB for the drivers. Implemented by libusb, or in tests by a fake with a virtual clock.
/// Thread: any that may wait, but not a rig's thread while it streams.
class UsbBus {
 public:
  virtual ~UsbBus() = default;

  /// Returns the plugged-in units of these models, sorted by bus and address. Does not open a unit whose serial number is readable
  /// in sysfs, since another program may be using it.
  [[nodiscard]] virtual core::Result<std::vector<UsbUnit>> units(std::span<const UsbModel> models) = 0;
  /// Opens the unit and claims its interface 0. Fails with DeviceGone if it was unplugged, with WrongState if another program or rig uses
  /// it, with NotAllowed if permission is missing (the hint names the udev rule). The bus must outlive the port.
  [[nodiscard]] virtual core::Result<std::unique_ptr<UsbPort>> open(const UsbUnit& unit) = 0;
  /// Returns how many devices were plugged in since the bus began to watch. Thread: any. Realtime-safe: yes.
  [[nodiscard]] virtual std::uint64_t arrivals() const noexcept = 0;
};

}  // namespace dts::device::usb
