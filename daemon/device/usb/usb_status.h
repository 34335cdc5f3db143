// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/result.h"

namespace dts::device::usb {

/// How a transfer ended.
enum class UsbStatus : std::uint8_t {
  Completed,  ///< The asked-for bytes, or fewer when the device ended with a short packet.
  Stall,      ///< The endpoint is halted (bulk) or the request is refused (control).
  NoDevice,   ///< The device is gone.
  Overflow,   ///< The device sent more than there was room for; data are lost.
  TimedOut,
  Cancelled,  ///< By the host.
  NoMemory,   ///< The kernel's memory for USB transfers is used up.
  Failed,     ///< CRC, protocol or host controller error.
};

inline constexpr std::size_t kUsbStatuses = static_cast<std::size_t>(UsbStatus::Failed) + 1;

/// Bytes moved, or why not.
using UsbResult = tl::expected<std::size_t, UsbStatus>;

/// "device stalled", "device is gone": the end of a sentence.
[[nodiscard]] std::string to_string(UsbStatus status);

/// `what` failed with `status`: DeviceGone, Timeout or Failed.
[[nodiscard]] core::Error to_error(UsbStatus status, const std::string& what, std::string hint = {});

}  // namespace dts::device::usb
