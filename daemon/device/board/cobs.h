// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace dts::device::board {

/// Consistent Overhead Byte Stuffing (Cheshire & Baker 1999) of short frames: the result contains no 0x00, so 0x00 can end a frame. The
/// code byte 0xFF (254 bytes without a zero) never occurs, because no frame is that long.
inline constexpr std::size_t kMostStuffed = 254;  ///< Bytes of the longest stuffed frame, without its 0x00.
inline constexpr std::size_t kMostPlain = kMostStuffed - 1;

/// Writes the stuffed form of `plain` to `out` and returns its length: one byte more. `plain` has at most `kMostPlain` bytes; `out` must be
/// larger by one. Realtime-safe: yes.
[[nodiscard]] std::size_t stuff(std::span<const std::uint8_t> plain, std::span<std::uint8_t> out) noexcept;

/// Writes the plain form of `stuffed` (without its 0x00) to `out` and returns its length; nothing if `stuffed` is empty, too long, contains
/// a zero or points beyond its end. `out` must be as large as `stuffed`. Realtime-safe: yes.
[[nodiscard]] std::optional<std::size_t> unstuff(std::span<const std::uint8_t> stuffed, std::span<std::uint8_t> out) noexcept;

}  // namespace dts::device::board
