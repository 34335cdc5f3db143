// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "device/usb/daq_driver.h"
#include "device/usb/usb_port.h"

namespace dts::device::labjack {

// Endpoints, frames and error numbers: U6 data sheet, section 5 (low-level function reference); addresses as in Exodriver.
inline constexpr std::uint8_t kCommandEndpoint = 0x01;
inline constexpr std::uint8_t kReplyEndpoint = 0x82;
inline constexpr std::uint8_t kStreamEndpoint = 0x83;
inline constexpr std::size_t kUsbPacketBytes = 64;

inline constexpr std::uint8_t kErrorStreamActive = 48;
inline constexpr std::uint8_t kErrorStreamNotRunning = 52;

/// Returns the sum of the bytes, folded twice to 8 bits with the carry added.
[[nodiscard]] std::uint8_t checksum8(std::span<const std::uint8_t> bytes) noexcept;
/// Returns the low 16 bits of the sum of the bytes.
[[nodiscard]] std::uint16_t checksum16(std::span<const std::uint8_t> bytes) noexcept;
/// Checks bytes 1 to 5 against byte 0, and the bytes from 6 on against bytes 4 and 5. Needs at least 6 bytes.
[[nodiscard]] bool has_right_checksums(std::span<const std::uint8_t> extended_frame) noexcept;

/// A command, and the form of its reply.
///
///     normal    0 checksum8 | 1 command | 2.. data
///     extended  0 checksum8 | 1 F8 | 2 words from 6 on | 3 command | 4 5 checksum16 | 6.. data
struct Command {
  std::string_view name;
  std::vector<std::uint8_t> bytes;
  std::uint8_t reply_code = 0;  ///< Byte 1 of a normal reply, byte 3 of an extended one.
  std::size_t reply_bytes = 0;
  bool is_extended = true;
};

struct StreamSetup {
  std::uint8_t samples_per_packet = 25;
  std::uint8_t scan_config = 0;  ///< Bit 3: 48 MHz instead of 4 MHz; bit 1: divided by 256.
  std::uint16_t interval = 1;    ///< Clock ticks per scan.
  std::vector<std::uint8_t> channels;
  std::vector<std::uint8_t> options;  ///< Per channel: gain index in bits 4 and 5.
};

[[nodiscard]] Command read_unit();  ///< ConfigU6 without changes.
[[nodiscard]] Command read_calibration(std::uint8_t block);
[[nodiscard]] Command turn_timers_off();  ///< ConfigIO.
[[nodiscard]] Command configure_stream(const StreamSetup& setup);
[[nodiscard]] Command start_stream();
[[nodiscard]] Command stop_stream();

struct Reply {
  std::vector<std::uint8_t> bytes;
  std::uint8_t error = 0;
};

/// Sends `command` and reads its reply, which may contain an error number. Skips old replies that an earlier program did not read.
/// Fails with Timeout (`timeout_ms` in each direction), DeviceGone or DataDamaged (short reply, wrong checksum, command not understood).
[[nodiscard]] core::Result<Reply> exchange(usb::UsbPort& port, const Command& command, int timeout_ms = usb::kSetupTimeoutMs);
/// Does the same, but also fails if the reply contains an error number.
[[nodiscard]] core::Result<Reply> run(usb::UsbPort& port, const Command& command, int timeout_ms = usb::kSetupTimeoutMs);
[[nodiscard]] core::Error refused(std::string_view command, std::uint8_t error);

}  // namespace dts::device::labjack
