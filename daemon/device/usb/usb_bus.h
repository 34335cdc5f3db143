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

/// A product that some driver knows.
struct UsbModel {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;
  std::string_view name;  ///< "USB-1608FS-Plus"
  std::string_view uri;   ///< What a user writes to have it: "mcc:1608fs-plus".
};

/// The machine's USB as the drivers see it. Behind it: libusb, or a fake with a virtual clock.
/// Thread: any that may wait, but not a sample thread while it streams.
class UsbBus {
 public:
  virtual ~UsbBus() = default;

  /// Units of these models that are plugged in now, in the order of bus and address. Opens no unit that has a readable
  /// serial number in sysfs: another program may be using it.
  [[nodiscard]] virtual core::Result<std::vector<UsbUnit>> units(std::span<const UsbModel> models) = 0;
  /// Opens the unit and claims its interface 0. DeviceGone: no longer there. WrongState: another program (or rig) has it.
  /// NotAllowed: permission is missing, the hint names the udev rule. The bus must outlive the port.
  [[nodiscard]] virtual core::Result<std::unique_ptr<UsbPort>> open(const UsbUnit& unit) = 0;
  /// Counts units that were plugged in since the bus was made. Thread: any. Realtime-safe: yes.
  [[nodiscard]] virtual std::uint64_t arrivals() const noexcept = 0;
};

}  // namespace dts::device::usb
