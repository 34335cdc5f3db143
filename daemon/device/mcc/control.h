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

/// Sends a vendor request with data; `what` describes it in the error.
[[nodiscard]] core::Status put(usb::UsbPort& port, const usb::ControlRequest& request, std::span<const std::uint8_t> bytes,
                               const std::string& what, int timeout_ms = usb::kSetupTimeoutMs);
[[nodiscard]] core::Status put(usb::UsbPort& port, const usb::ControlRequest& request, const std::string& what,
                               int timeout_ms = usb::kSetupTimeoutMs);
/// Reads exactly `count` bytes with a vendor request; fails with DataDamaged if fewer arrive.
[[nodiscard]] core::Result<std::vector<std::uint8_t>> get(usb::UsbPort& port, const usb::ControlRequest& request, std::size_t count,
                                                          const std::string& what, int timeout_ms = usb::kSetupTimeoutMs);
/// Reads two bytes, little endian, like `get`.
[[nodiscard]] core::Result<std::uint16_t> get_word(usb::UsbPort& port, const usb::ControlRequest& request, const std::string& what,
                                                   int timeout_ms = usb::kSetupTimeoutMs);

/// Discards the data of an earlier scan. Clears the halt first: old packets may wait after it and would become the start of the
/// next scan. Fails if the device still sends after 250 ms.
[[nodiscard]] core::Status empty_endpoint(usb::UsbPort& port, std::uint8_t endpoint);
/// Polls the state after a stop request until the device reports that it no longer scans. Fails with Failed if it keeps scanning.
[[nodiscard]] core::Status await_end(usb::DaqDriver& driver, usb::UsbPort& port);

/// Appends an integer in little endian.
void append_u32(std::vector<std::uint8_t>& bytes, std::uint32_t value);

/// Sets the output `bit` to the given level: reads the latch, then writes it. Does not change the other lines.
[[nodiscard]] core::Status drive_line(usb::UsbPort& port, unsigned bit, bool is_high, int timeout_ms = usb::kControlTimeoutMs);

/// How a device makes digital lines outputs.
enum class LineDirection : std::uint8_t {
  PerLine,  ///< A mask with one bit per line, 0: output. The other lines do not change.
  PerPort,  ///< One value for all 8 lines, 0: outputs, 1: inputs. The other 7 lines output their latches.
};
/// Makes line `bit` an output at low level.
[[nodiscard]] core::Status prepare_line(usb::UsbPort& port, unsigned bit, LineDirection direction);

/// Result of `read_codes`.
struct CodesRead {
  std::size_t bytes = 0;
  std::size_t codes = 0;
  bool is_damaged = false;  ///< Half a code at the end, or a code above `largest`.
};
/// Reads consecutive 16 bit codes, little endian.
[[nodiscard]] CodesRead read_codes(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes, std::uint16_t largest) noexcept;

}  // namespace dts::device::mcc
