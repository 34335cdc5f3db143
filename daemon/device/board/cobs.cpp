// SPDX-License-Identifier: Apache-2.0
#include "device/board/cobs.h"

namespace dts::device::board {

std::size_t stuff(std::span<const std::uint8_t> plain, std::span<std::uint8_t> out) noexcept {
  std::size_t code_at = 0;
  std::size_t length = 1;
  for (const std::uint8_t byte : plain) {
    if (byte != 0) {
      out[length++] = byte;
      continue;
    }
    out[code_at] = static_cast<std::uint8_t>(length - code_at);
    code_at = length++;
  }
  out[code_at] = static_cast<std::uint8_t>(length - code_at);
  return length;
}

std::optional<std::size_t> unstuff(std::span<const std::uint8_t> stuffed, std::span<std::uint8_t> out) noexcept {
  if (stuffed.empty() || stuffed.size() > kMostStuffed) return std::nullopt;
  std::size_t length = 0;
  std::size_t at = 0;
  while (at < stuffed.size()) {
    const std::size_t code = stuffed[at++];
    if (code == 0 || code - 1 > stuffed.size() - at) return std::nullopt;
    for (const std::size_t end = at + code - 1; at < end; ++at) {
      if (stuffed[at] == 0) return std::nullopt;
      out[length++] = stuffed[at];
    }
    if (at < stuffed.size()) out[length++] = 0;
  }
  return length;
}

}  // namespace dts::device::board
