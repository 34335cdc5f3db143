// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace dts::emulator {

/// The head of every USB/IP message, 48 bytes of big-endian words (kernel: Documentation/usb/usbip_protocol.rst).
///
///     0 command | 4 seqnum | 8 devid | 12 direction | 16 ep | 20 ... by command
///     SUBMIT:      20 flags | 24 length | 28 frame | 32 packets | 36 interval | 40 setup[8]   OUT data follow
///     RET_SUBMIT:  20 status | 24 actual length | 28 frame | 32 packets | 36 errors           IN data follow
///     UNLINK:      20 seqnum of the transfer          RET_UNLINK:  20 status
class UsbipMessage {
 public:
  static constexpr std::size_t kBytes = 48;
  static constexpr std::uint32_t kSubmit = 1;
  static constexpr std::uint32_t kUnlink = 2;
  static constexpr std::uint32_t kReturnSubmit = 3;
  static constexpr std::uint32_t kReturnUnlink = 4;
  static constexpr std::uint32_t kNotIsochronous = 0xffffffff;

  [[nodiscard]] std::uint32_t word(std::size_t at) const noexcept {
    return static_cast<std::uint32_t>(bytes[at]) << 24 | static_cast<std::uint32_t>(bytes[at + 1]) << 16 |
           static_cast<std::uint32_t>(bytes[at + 2]) << 8 | bytes[at + 3];
  }
  void set_word(std::size_t at, std::uint32_t value) noexcept {
    for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
  }

  [[nodiscard]] std::uint32_t command() const noexcept { return word(0); }
  [[nodiscard]] std::uint32_t seqnum() const noexcept { return word(4); }
  [[nodiscard]] bool is_in() const noexcept { return word(12) == 1; }
  [[nodiscard]] std::uint32_t endpoint() const noexcept { return word(16); }
  [[nodiscard]] std::uint32_t length() const noexcept { return word(24); }

  std::array<std::uint8_t, kBytes> bytes{};
};

}  // namespace dts::emulator
