// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"
#include "device/usb/usb_port.h"
#include "device/usb/usb_status.h"

namespace dts::device::usb {

/// How a transfer ended, from a libusb_transfer_status.
[[nodiscard]] UsbStatus status_of_transfer(int transfer_status) noexcept;
/// Why something could not even begin, from a (negative) libusb_error.
[[nodiscard]] UsbStatus status_of_error(int libusb_error) noexcept;

/// "USB device 09db:00ea at /dev/bus/usb/001/002, serial 01AB": for messages.
[[nodiscard]] std::string name_of(const UsbUnit& unit);

/// Why a device could not be opened or claimed. `open_errno` is what open(2) says of the node, 0: it opens; libusb gives the same
/// code for a udev rule that is missing (EACCES) and for a service whose device policy forbids the node (EPERM).
[[nodiscard]] core::Error open_error(int libusb_error, int open_errno, const UsbUnit& unit);

}  // namespace dts::device::usb
