// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dts::emulator {

[[nodiscard]] inline std::uint8_t low_byte(unsigned word) noexcept { return static_cast<std::uint8_t>(word); }
[[nodiscard]] inline std::uint8_t high_byte(unsigned word) noexcept { return static_cast<std::uint8_t>(word >> 8U); }

/// LabJack's 8 bit checksum of a sum of bytes: the carries are added in again.
[[nodiscard]] inline std::uint8_t folded(unsigned sum) noexcept {
  sum = sum / 256 + sum % 256;
  return static_cast<std::uint8_t>(sum / 256 + sum % 256);
}

}  // namespace dts::emulator
