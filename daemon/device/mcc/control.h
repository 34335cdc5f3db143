// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "device/usb/usb_port.h"

namespace dts::device::mcc {

inline constexpr unsigned kCodeBytes = 2;

/// A vendor request with data to the device; an error says that `what` failed.
[[nodiscard]] core::Status put(usb::UsbPort& port, const usb::ControlRequest& request, std::span<const std::uint8_t> bytes,
                               const std::string& what);
[[nodiscard]] core::Status put(usb::UsbPort& port, const usb::ControlRequest& request, const std::string& what);
/// A vendor request that must bring exactly `count` bytes; DataDamaged when it brings fewer.
[[nodiscard]] core::Result<std::vector<std::uint8_t>> get(usb::UsbPort& port, const usb::ControlRequest& request, std::size_t count,
                                                          const std::string& what);
/// As `get`, two bytes, little endian.
[[nodiscard]] core::Result<std::uint16_t> get_word(usb::UsbPort& port, const usb::ControlRequest& request, const std::string& what);

/// Takes and forgets what an earlier scan left on its way, at most `most_packets`; ends at silence or a stall.
[[nodiscard]] core::Status drain(usb::UsbPort& port, std::uint8_t endpoint, std::size_t packet_bytes, std::size_t most_packets);
[[nodiscard]] core::Status clear_halt(usb::UsbPort& port, std::uint8_t endpoint);

/// Appends an integer in little endian.
void append_u32(std::vector<std::uint8_t>& bytes, std::uint32_t value);

/// Digital line `bit` as an output at the given level. The other lines stay as they are.
[[nodiscard]] core::Status drive_line(usb::UsbPort& port, unsigned bit, bool is_high);
/// Makes line `bit` an output that is low.
[[nodiscard]] core::Status prepare_line(usb::UsbPort& port, unsigned bit);

/// Codes of 16 bits, little endian, back to back. Integrity: half a code at the end, or a code above `largest`.
struct CodesRead {
  std::size_t bytes = 0;
  std::size_t codes = 0;
  bool is_damaged = false;
};
[[nodiscard]] CodesRead read_codes(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes, std::uint16_t largest) noexcept;

}  // namespace dts::device::mcc
