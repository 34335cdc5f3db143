// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"
#include "device/usb/usb_port.h"
#include "device/usb/usb_status.h"

namespace dts::device::usb {

/// Converts a libusb_transfer_status: how a transfer ended.
[[nodiscard]] UsbStatus status_of_transfer(int transfer_status) noexcept;
/// Converts a (negative) libusb_error: why a call failed.
[[nodiscard]] UsbStatus status_of_error(int libusb_error) noexcept;

/// Returns "USB device 09db:00ea at /dev/bus/usb/001/002, serial 01AB", for messages.
[[nodiscard]] std::string name_of(const UsbUnit& unit);

/// Returns the error for a device that could not be opened or claimed. `open_errno` is the errno of open(2) on the device file, 0: no
/// error. It is needed because libusb has only one code for a missing udev rule (EACCES) and for a service whose device policy forbids
/// the device file (EPERM).
[[nodiscard]] core::Error open_error(int libusb_error, int open_errno, const UsbUnit& unit);

}  // namespace dts::device::usb
