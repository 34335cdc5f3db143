// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include "core/block.h"

namespace dts::device::board {

inline constexpr std::size_t kMostPayload = 249;  ///< Bytes of a frame's payload.
inline constexpr std::size_t kCrcBytes = 4;
inline constexpr std::size_t kMostScansInFrame = (kMostPayload - 11) / 2;

inline constexpr double kLowestRateHz = 1.0;
inline constexpr double kHighestRateHz = 20'000.0;

/// The first byte of a payload.
enum class FrameType : std::uint8_t {
  Descriptor = 0x01,
  Channel = 0x02,
  Scans = 0x03,
  Lost = 0x04,
  Log = 0x05,
  Describe = 0x81,
  Start = 0x82,
  Stop = 0x83,
  Pattern = 0x84,
};

/// A short text without memory of its own on the heap: the reader of scans must not allocate.
template <std::size_t kMost>
class ShortText {
 public:
  ShortText() = default;
  /// Keeps at most `kMost` bytes.
  explicit ShortText(std::string_view text) noexcept : length_(static_cast<std::uint8_t>(std::min(text.size(), kMost))) {
    std::copy_n(text.data(), length_, bytes_.begin());
  }
  [[nodiscard]] std::string_view view() const noexcept { return {bytes_.data(), length_}; }
  friend bool operator==(const ShortText& a, const ShortText& b) noexcept { return a.view() == b.view(); }

 private:
  std::array<char, kMost> bytes_{};
  std::uint8_t length_ = 0;
};

/// A rate as the wire has it; 0/1: unknown (DESCRIPTOR) or the board's own (START).
struct WireRate {
  std::uint32_t numerator = 0;
  std::uint32_t denominator = 1;

  [[nodiscard]] bool is_known() const noexcept { return numerator != 0; }
  [[nodiscard]] double hz() const noexcept { return static_cast<double>(numerator) / static_cast<double>(denominator); }
  friend bool operator==(const WireRate&, const WireRate&) = default;
};

struct Descriptor {
  std::size_t channels = 0;
  unsigned converter_bits = 0;
  WireRate rate;  ///< The rate that the board really runs.
  std::uint32_t ticks_per_second = 0;
  bool carries_time = false;       ///< The ticks of SCANS are valid.
  bool starts_on_command = false;  ///< The board scans between START and STOP only.
  bool is_pattern = false;         ///< The board sends its test pattern.
  bool is_streaming = false;
  ShortText<32> serial;
  ShortText<32> model;
  ShortText<32> firmware;
};

struct Channel {
  std::size_t index = 0;
  bool is_constant = false;  ///< Every code is `lowest`.
  bool is_digital = false;
  std::int16_t lowest = 0;
  std::int16_t highest = 0;
  float scale = 0.0F;
  float offset = 0.0F;
  ShortText<16> name;
  ShortText<16> unit;

  /// Returns code * scale + offset, rounded once to a float. Realtime-safe: yes.
  [[nodiscard]] float value(std::int16_t code) const noexcept;
  friend bool operator==(const Channel&, const Channel&) = default;
};

struct Scans {
  std::uint8_t run = 0;
  std::uint32_t counter = 0;  ///< Of the first scan.
  std::uint32_t ticks = 0;    ///< Of the first scan.
  std::size_t count = 0;
  std::span<const std::uint8_t> codes;  ///< Little endian, scan after scan; part of the payload.

  /// Returns a code; `position` counts through all scans. Realtime-safe: yes.
  [[nodiscard]] std::int16_t code(std::size_t position) const noexcept {
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(codes[2 * position] | codes[2 * position + 1] << 8U));
  }
};

/// Why the board lost scans, or stopped.
enum class LostReason : std::uint8_t { BufferFull = 1, Late = 2, Stopped = 4 };

struct Lost {
  std::uint8_t run = 0;
  std::uint32_t counter = 0;  ///< Of the next scan.
  std::uint8_t reason = 0;    ///< See `LostReason`; other values are possible.
  std::uint32_t lost = 0;
};

/// A rejected field of a frame. Plain data, because the reader of scans must not allocate.
struct Refusal {
  const char* frame = "";  ///< "DESCRIPTOR"
  int channel = -1;        ///< Index of a CHANNEL frame; -1: none.
  const char* field = "";  ///< "rate"
  double value = 0.0;      ///< NaN: not shown.
  const char* rule = "";   ///< "Hz is outside 1 to 20000 Hz"
  /// The frame itself is wrong (length, index, count), so it says nothing about the board: it is dropped and counted.
  bool is_malformed = false;
};

/// Returns "DESCRIPTOR: rate 0.5 Hz is outside 1 to 20000 Hz".
[[nodiscard]] std::string to_string(const Refusal& refusal);

template <class T>
using Parsed = tl::expected<T, Refusal>;

// Each of these parses one payload, from its type byte on, and checks every field. Realtime-safe: yes.
[[nodiscard]] Parsed<Descriptor> parse_descriptor(std::span<const std::uint8_t> payload) noexcept;
[[nodiscard]] Parsed<Channel> parse_channel(std::span<const std::uint8_t> payload) noexcept;
/// `channels`: of the board's DESCRIPTOR.
[[nodiscard]] Parsed<Scans> parse_scans(std::span<const std::uint8_t> payload, std::size_t channels) noexcept;
[[nodiscard]] Parsed<Lost> parse_lost(std::span<const std::uint8_t> payload) noexcept;
/// Returns the text of a LOG; it may contain anything.
[[nodiscard]] Parsed<ShortText<120>> parse_log(std::span<const std::uint8_t> payload) noexcept;

/// Bytes to send, with the 0x00 at the end.
struct EncodedFrame {
  std::array<std::uint8_t, 256> bytes{};
  std::size_t length = 0;
  [[nodiscard]] std::span<const std::uint8_t> view() const noexcept { return {bytes.data(), length}; }
};

/// Returns the payload with CRC, stuffed and ended. `payload` has 1 to `kMostPayload` bytes. Realtime-safe: yes.
[[nodiscard]] EncodedFrame encode_frame(std::span<const std::uint8_t> payload) noexcept;

// The commands of the host. Each begins with a 0x00 too: so a part of an earlier command, or noise, does not spoil it.
[[nodiscard]] EncodedFrame describe_command() noexcept;
[[nodiscard]] EncodedFrame start_command(WireRate rate) noexcept;
[[nodiscard]] EncodedFrame stop_command() noexcept;
[[nodiscard]] EncodedFrame pattern_command(bool is_on) noexcept;

/// Returns the CRC-32 (IEEE) of the bytes. Realtime-safe: yes.
[[nodiscard]] std::uint32_t crc32(std::span<const std::uint8_t> bytes) noexcept;

}  // namespace dts::device::board
