// SPDX-License-Identifier: Apache-2.0
#include "dts/zmtp/zmtp.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace dts::zmtp {
namespace {

constexpr std::uint8_t kMore = 1;
constexpr std::uint8_t kLong = 2;
constexpr std::uint8_t kCommand = 4;
constexpr std::size_t kShortHeader = 2;
constexpr std::size_t kLongHeader = 9;
constexpr std::size_t kLongestShortBody = 255;
constexpr std::size_t kMechanismAt = 12;
constexpr std::size_t kMechanismBytes = 20;
constexpr std::size_t kLongestPingContext = 16;
constexpr std::size_t kPingTtlBytes = 2;

std::uint8_t number(std::byte byte) noexcept { return std::to_integer<std::uint8_t>(byte); }

std::uint64_t big_endian(std::span<const std::byte> bytes) noexcept {
  std::uint64_t value = 0;
  for (const std::byte byte : bytes) value = value << 8U | number(byte);
  return value;
}

std::string_view text_of(std::span<const std::byte> bytes) noexcept { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

void append_big_endian(std::string& out, std::uint64_t value, int bytes) {
  for (int byte = bytes - 1; byte >= 0; --byte) out += static_cast<char>(value >> (8 * byte) & 0xffU);
}

void append_header(std::string& out, std::uint8_t flags, std::size_t size) {
  const bool is_long = size > kLongestShortBody;
  out += static_cast<char>(flags | (is_long ? kLong : 0U));
  append_big_endian(out, size, is_long ? 8 : 1);
}

bool is_same_name(std::string_view one, std::string_view other) noexcept {
  const auto lower = [](char letter) { return std::tolower(static_cast<unsigned char>(letter)); };
  return std::ranges::equal(one, other, {}, lower, lower);
}

}  // namespace

std::string greeting() {
  std::string bytes(kGreetingBytes, '\0');
  bytes[0] = '\xff';
  bytes[9] = '\x7f';
  bytes[10] = 3;
  bytes.replace(kMechanismAt, 4, "NULL");
  return bytes;
}

std::string_view fault_of_greeting(std::span<const std::byte> bytes) noexcept {
  const auto is_at = [bytes](std::size_t place, std::uint8_t wanted) { return bytes.size() <= place || number(bytes[place]) == wanted; };
  if (!is_at(0, 0xff) || !is_at(9, 0x7f)) return "the peer does not speak ZMTP";
  if (bytes.size() > 10 && number(bytes[10]) < 3) return "the peer speaks an older ZMTP than 3.0";
  constexpr std::array<char, kMechanismBytes> kNull = {'N', 'U', 'L', 'L'};
  for (std::size_t i = 0; i < kMechanismBytes; ++i) {
    if (!is_at(kMechanismAt + i, static_cast<std::uint8_t>(kNull[i]))) return "the peer wants another mechanism than NULL";
  }
  return {};
}

FrameResult next_frame(std::span<const std::byte> bytes, std::size_t limit) noexcept {
  if (bytes.empty()) return std::nullopt;
  const std::uint8_t flags = number(bytes[0]);
  const bool is_command = (flags & kCommand) != 0;
  if ((flags & ~(kMore | kLong | kCommand)) != 0 || (is_command && (flags & kMore) != 0))
    return "a frame with flags that ZMTP does not know";
  const std::size_t header = (flags & kLong) != 0 ? kLongHeader : kShortHeader;
  if (bytes.size() < header) return std::nullopt;
  const std::uint64_t size = big_endian(bytes.subspan(1, header - 1));
  if (size > limit) return "a frame that is too long";
  if (bytes.size() - header < size) return std::nullopt;
  const auto length = static_cast<std::size_t>(size);
  return Frame{.is_command = is_command, .has_more = (flags & kMore) != 0, .body = bytes.subspan(header, length), .size = header + length};
}

void append_frame(std::string& out, std::string_view body, bool has_more) {
  append_header(out, has_more ? kMore : 0, body.size());
  out += body;
}

void append_command(std::string& out, std::string_view name, std::string_view data) {
  append_header(out, kCommand, 1 + name.size() + data.size());
  out += static_cast<char>(name.size());
  out += name;
  out += data;
}

void append_ready(std::string& out, std::string_view socket_type) {
  constexpr std::string_view kName = "Socket-Type";
  std::string data(1, static_cast<char>(kName.size()));
  data += kName;
  append_big_endian(data, socket_type.size(), 4);
  data += socket_type;
  append_command(out, "READY", data);
}

std::optional<Command> command_of(std::span<const std::byte> body) noexcept {
  const std::string_view text = text_of(body);
  if (text.empty()) return std::nullopt;
  const auto length = static_cast<std::size_t>(static_cast<unsigned char>(text[0]));
  if (length == 0 || text.size() < 1 + length) return std::nullopt;
  return Command{.name = text.substr(1, length), .data = text.substr(1 + length)};
}

std::optional<std::string_view> property_of(std::string_view ready_data, std::string_view name) noexcept {
  constexpr std::size_t kLengthBytes = 4;
  while (!ready_data.empty()) {
    const auto name_length = static_cast<std::size_t>(static_cast<unsigned char>(ready_data[0]));
    if (name_length == 0 || ready_data.size() < 1 + name_length + kLengthBytes) return std::nullopt;
    const std::string_view found = ready_data.substr(1, name_length);
    ready_data.remove_prefix(1 + name_length);
    const std::uint64_t length = big_endian(std::as_bytes(std::span(ready_data)).first(kLengthBytes));
    ready_data.remove_prefix(kLengthBytes);
    if (length > ready_data.size()) return std::nullopt;
    const std::string_view value = ready_data.substr(0, static_cast<std::size_t>(length));
    if (is_same_name(found, name)) return value;
    ready_data.remove_prefix(value.size());
  }
  return std::nullopt;
}

void append_pong(std::string& out, std::string_view ping_data) {
  if (ping_data.size() < kPingTtlBytes || ping_data.size() > kPingTtlBytes + kLongestPingContext) return;
  append_command(out, "PONG", ping_data.substr(kPingTtlBytes));
}

}  // namespace dts::zmtp
