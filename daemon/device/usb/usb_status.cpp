// SPDX-License-Identifier: Apache-2.0
#include "device/usb/usb_status.h"

#include <utility>

namespace dts::device::usb {

std::string to_string(UsbStatus status) {
  switch (status) {
    case UsbStatus::Completed: return "completed";
    case UsbStatus::Stall: return "device rejected it (stall)";
    case UsbStatus::NoDevice: return "device is gone";
    case UsbStatus::Overflow: return "device sent more data than the buffer holds";
    case UsbStatus::TimedOut: return "device did not answer in time";
    case UsbStatus::Cancelled: return "cancelled";
    case UsbStatus::NoMemory: return "no memory or no file descriptor is left for USB transfers";
    case UsbStatus::Failed: return "transfer failed on the bus (cable, hub or host controller)";
  }
  return "unknown status " + std::to_string(static_cast<int>(status));
}

core::Error to_error(UsbStatus status, const std::string& what, std::string hint) {
  core::ErrorCode code = core::ErrorCode::Failed;
  if (status == UsbStatus::NoDevice) code = core::ErrorCode::DeviceGone;
  if (status == UsbStatus::TimedOut) code = core::ErrorCode::Timeout;
  if (status == UsbStatus::NoMemory && hint.empty())
    hint = "end clients that are not needed, or write a larger number to /sys/module/usbcore/parameters/usbfs_memory_mb";
  return {code, what + ": " + to_string(status), std::move(hint)};
}

}  // namespace dts::device::usb
