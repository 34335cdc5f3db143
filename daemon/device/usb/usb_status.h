// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/result.h"

namespace dts::device::usb {

/// How a transfer ended.
enum class UsbStatus : std::uint8_t {
  Completed,  ///< All requested bytes, or fewer if the device ended with a short packet.
  Stall,      ///< The endpoint is halted (bulk) or the device rejected the request (control).
  NoDevice,   ///< The device is gone.
  Overflow,   ///< The device sent more than the buffer holds; data are lost.
  TimedOut,
  Cancelled,  ///< By the host.
  NoMemory,   ///< No memory or file descriptor is left for USB transfers.
  Failed,     ///< CRC, protocol or host controller error.
};

inline constexpr std::size_t kUsbStatuses = static_cast<std::size_t>(UsbStatus::Failed) + 1;

/// Number of transferred bytes, or why the transfer failed.
using UsbResult = tl::expected<std::size_t, UsbStatus>;

/// Returns the end of a sentence: "device is gone".
[[nodiscard]] std::string to_string(UsbStatus status);

/// Returns an error for `what` that failed with `status`: DeviceGone, Timeout or Failed.
[[nodiscard]] core::Error to_error(UsbStatus status, const std::string& what, std::string hint = {});

}  // namespace dts::device::usb
