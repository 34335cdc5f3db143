// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

namespace dts::record {

inline constexpr std::string_view kMagic = "XDF:";
inline constexpr std::uint64_t kMaxChunkBytes = 64U << 20U;  ///< Readers reject longer chunks; our chunks hold at most 0.2 s.
inline constexpr std::size_t kMaxXmlBytes = 8U << 20U;
inline constexpr std::size_t kMaxChannels = 4096;

/// [prefix bytes: 1, 4 or 8][length, little endian: of tag and content][tag, u16][content]
enum class ChunkTag : std::uint16_t { FileHeader = 1, StreamHeader = 2, Samples = 3, ClockOffset = 4, Boundary = 5, StreamFooter = 6 };

/// The specification's mark: a reader that lost its place can search for it and continue there.
inline constexpr std::string_view kBoundaryMark = "\x43\xA5\x46\xDC\xCB\xF5\x41\x0F\xB3\x0E\xD5\x46\x73\x83\xCB\xE4";

/// Appends a number in little-endian byte order.
template <class Number>
void put(std::string& bytes, Number number) {
  std::array<char, sizeof(Number)> raw{};
  std::memcpy(raw.data(), &number, sizeof(Number));
  if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(raw);
  bytes.append(raw.data(), raw.size());
}

/// Appends the number of bytes of the length, then the length, in the shortest form that the specification allows.
inline void put_length(std::string& bytes, std::uint64_t length) {
  if (length <= std::numeric_limits<std::uint8_t>::max()) {
    put(bytes, std::uint8_t{1});
    put(bytes, static_cast<std::uint8_t>(length));
  } else if (length <= std::numeric_limits<std::uint32_t>::max()) {
    put(bytes, std::uint8_t{4});
    put(bytes, static_cast<std::uint32_t>(length));
  } else {
    put(bytes, std::uint8_t{8});
    put(bytes, length);
  }
}

[[nodiscard]] inline std::string make_chunk(ChunkTag tag, std::string_view content) {
  std::string chunk;
  chunk.reserve(content.size() + 11);
  put_length(chunk, content.size() + sizeof(std::uint16_t));
  put(chunk, static_cast<std::uint16_t>(tag));
  return chunk.append(content);
}

/// Reads numbers from the front of `bytes`. Each `read` returns false if too few bytes are left.
class ByteCursor {
 public:
  explicit ByteCursor(std::string_view bytes) noexcept : left_(bytes) {}

  template <class Number>
  [[nodiscard]] bool read(Number& number) noexcept {
    if (left_.size() < sizeof(Number)) return false;
    std::array<char, sizeof(Number)> raw{};
    std::memcpy(raw.data(), left_.data(), sizeof(Number));
    if constexpr (std::endian::native == std::endian::big) std::ranges::reverse(raw);
    std::memcpy(&number, raw.data(), sizeof(Number));
    left_.remove_prefix(sizeof(Number));
    return true;
  }
  [[nodiscard]] bool read_length(std::uint64_t& length) noexcept {
    std::uint8_t bytes = 0;
    if (!read(bytes)) return false;
    if (bytes == 8) return read(length);
    if (bytes == 4) return read_as<std::uint32_t>(length);
    return bytes == 1 && read_as<std::uint8_t>(length);
  }
  [[nodiscard]] bool read_text(std::uint64_t length, std::string_view& text) noexcept {
    if (length > left_.size()) return false;
    text = left_.substr(0, static_cast<std::size_t>(length));
    left_.remove_prefix(static_cast<std::size_t>(length));
    return true;
  }
  [[nodiscard]] std::string_view left() const noexcept { return left_; }

 private:
  template <class Number>
  [[nodiscard]] bool read_as(std::uint64_t& length) noexcept {
    Number number = 0;
    if (!read(number)) return false;
    length = number;
    return true;
  }

  std::string_view left_;
};

}  // namespace dts::record
