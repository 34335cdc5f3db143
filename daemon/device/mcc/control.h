// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "device/usb/daq_driver.h"
#include "device/usb/usb_port.h"

namespace dts::device::mcc {

inline constexpr unsigned kCodeBytes = 2;

/// A vendor request with data to the device; an error says that `what` failed.
[[nodiscard]] core::Status put(usb::UsbPort& port, const usb::ControlRequest& request, std::span<const std::uint8_t> bytes,
                               const std::string& what, int timeout_ms = usb::kSetupTimeoutMs);
[[nodiscard]] core::Status put(usb::UsbPort& port, const usb::ControlRequest& request, const std::string& what,
                               int timeout_ms = usb::kSetupTimeoutMs);
/// A vendor request that must bring exactly `count` bytes; DataDamaged when it brings fewer.
[[nodiscard]] core::Result<std::vector<std::uint8_t>> get(usb::UsbPort& port, const usb::ControlRequest& request, std::size_t count,
                                                          const std::string& what, int timeout_ms = usb::kSetupTimeoutMs);
/// As `get`, two bytes, little endian.
[[nodiscard]] core::Result<std::uint16_t> get_word(usb::UsbPort& port, const usb::ControlRequest& request, const std::string& what,
                                                   int timeout_ms = usb::kSetupTimeoutMs);

/// Takes and forgets what an earlier scan left on its way. The halt goes first: behind it old packets may wait, which would head the
/// next scan. Fails when the device still sends after 250 ms.
[[nodiscard]] core::Status empty_endpoint(usb::UsbPort& port, std::uint8_t endpoint);
/// After a stop request: asks until the device says that it does not scan any more. Failed: it goes on.
[[nodiscard]] core::Status await_end(usb::DaqDriver& driver, usb::UsbPort& port);

/// Appends an integer in little endian.
void append_u32(std::vector<std::uint8_t>& bytes, std::uint32_t value);

/// Puts the output `bit` to the given level: the latch is read, then written. The other lines stay as they are.
[[nodiscard]] core::Status drive_line(usb::UsbPort& port, unsigned bit, bool is_high, int timeout_ms = usb::kControlTimeoutMs);

/// How digital lines become outputs.
enum class LineDirection : std::uint8_t {
  PerLine,  ///< A mask, 0: output. The other lines stay as they are.
  PerPort,  ///< 0 makes all 8 lines outputs, 1 inputs; the other 7 show what their latches hold.
};
/// Makes line `bit` an output that is low.
[[nodiscard]] core::Status prepare_line(usb::UsbPort& port, unsigned bit, LineDirection direction);

/// Codes of 16 bits, little endian, back to back. Integrity: half a code at the end, or a code above `largest`.
struct CodesRead {
  std::size_t bytes = 0;
  std::size_t codes = 0;
  bool is_damaged = false;
};
[[nodiscard]] CodesRead read_codes(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes, std::uint16_t largest) noexcept;

}  // namespace dts::device::mcc
