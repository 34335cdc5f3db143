// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "usb/emulator/emulated_device.h"

namespace dts::emulator {

// Little endian numbers and control replies, for the MCC emulators.

[[nodiscard]] inline std::uint32_t u32_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 4; i-- > 0;) word = word << 8U | bytes[at + i];
  return word;
}

inline void put_float(std::vector<std::uint8_t>& memory, std::size_t at, float value) {
  const auto word = std::bit_cast<std::uint32_t>(value);
  for (std::size_t i = 0; i < 4; ++i) memory[at + i] = static_cast<std::uint8_t>(word >> (8U * i));
}

[[nodiscard]] inline ControlReply refused() { return {.kind = ReplyKind::Stall, .data = {}}; }
[[nodiscard]] inline ControlReply silent() { return {.kind = ReplyKind::Silence, .data = {}}; }
[[nodiscard]] inline ControlReply done(std::vector<std::uint8_t> data = {}) { return {.kind = ReplyKind::Done, .data = std::move(data)}; }
[[nodiscard]] inline ControlReply done_u16(unsigned value) {
  return done({static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8U)});
}

}  // namespace dts::emulator
