// SPDX-License-Identifier: Apache-2.0
#include "device/usb/libusb_error.h"

#include <libusb-1.0/libusb.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace dts::device::usb {
namespace {

using core::ErrorCode;

constexpr const char* kRuleHint =
    "check the udev rule 70-dtsd.rules: the package dtsd installs it; from the sources, copy config/udev/70-dtsd.rules to "
    "/etc/udev/rules.d and run \"udevadm control --reload && udevadm trigger\"; then plug the device in again, and run dtsd as a member "
    "of the group dtsd";
constexpr const char* kPolicyHint =
    "allow it in the unit of the service: DeviceAllow=char-usb_device rw, and Wants= and After=modprobe@usbcore.service; then restart the "
    "service";
constexpr const char* kBusyHint = "close the other program, or the other rig, that uses it";

}  // namespace

UsbStatus status_of_transfer(int transfer_status) noexcept {
  switch (transfer_status) {
    case LIBUSB_TRANSFER_COMPLETED: return UsbStatus::Completed;
    case LIBUSB_TRANSFER_TIMED_OUT: return UsbStatus::TimedOut;
    case LIBUSB_TRANSFER_CANCELLED: return UsbStatus::Cancelled;
    case LIBUSB_TRANSFER_STALL: return UsbStatus::Stall;
    case LIBUSB_TRANSFER_NO_DEVICE: return UsbStatus::NoDevice;
    case LIBUSB_TRANSFER_OVERFLOW: return UsbStatus::Overflow;
    default: return UsbStatus::Failed;
  }
}

UsbStatus status_of_error(int libusb_error) noexcept {
  switch (libusb_error) {
    case LIBUSB_ERROR_NO_DEVICE: return UsbStatus::NoDevice;
    case LIBUSB_ERROR_PIPE: return UsbStatus::Stall;
    case LIBUSB_ERROR_TIMEOUT: return UsbStatus::TimedOut;
    case LIBUSB_ERROR_OVERFLOW: return UsbStatus::Overflow;
    case LIBUSB_ERROR_NO_MEM: return UsbStatus::NoMemory;
    default: return UsbStatus::Failed;
  }
}

std::string name_of(const UsbUnit& unit) {
  std::array<char, 16> ids{};
  std::snprintf(ids.data(), ids.size(), "%04x:%04x", unit.vendor, unit.product);
  return std::string("USB device ") + ids.data() + " at " + unit.node() + (unit.serial.empty() ? "" : ", serial " + unit.serial);
}

core::Error open_error(int libusb_error, int open_errno, const UsbUnit& unit) {
  const std::string what = "cannot open " + name_of(unit) + ": ";
  if (libusb_error == LIBUSB_ERROR_BUSY || open_errno == EBUSY)
    return {ErrorCode::WrongState, what + "another program or rig is using it", kBusyHint};
  if (libusb_error == LIBUSB_ERROR_NO_DEVICE || open_errno == ENOENT || open_errno == ENODEV || open_errno == ENXIO)
    return {ErrorCode::DeviceGone, what + "it is no longer there", "plug it in"};
  if (open_errno == EACCES)
    return {ErrorCode::NotAllowed, what + "no permission to write to the node (EACCES): the udev rule is missing", kRuleHint};
  if (open_errno == EPERM) return {ErrorCode::NotAllowed, what + "the system forbids it (EPERM)", kPolicyHint};
  const std::string why = open_errno != 0 ? std::strerror(open_errno) : libusb_strerror(libusb_error);
  return {ErrorCode::Failed, what + why, "unplug the device and plug it in again"};
}

}  // namespace dts::device::usb
