// SPDX-License-Identifier: Apache-2.0
#include "device/board/frames.h"

#include <algorithm>
#include <bit>
#include <boost/crc.hpp>
#include <cmath>
#include <limits>

#include "core/number_text.h"
#include "core/utf8.h"
#include "device/board/cobs.h"

namespace dts::device::board {
namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint8_t kVersion = 1;
constexpr unsigned kMostConverterBits = 32;
constexpr std::size_t kScansHead = 11;
constexpr std::size_t kLostLength = 11;
constexpr std::size_t kMostLogText = 120;

/// Reads little-endian fields one after the other. After a read beyond the end, all further fields are zero.
class FieldReader {
 public:
  explicit FieldReader(std::span<const std::uint8_t> bytes) noexcept : bytes_(bytes) {}

  std::uint8_t u8() noexcept { return static_cast<std::uint8_t>(number(1)); }
  std::uint32_t u32() noexcept { return number(4); }
  std::int16_t i16() noexcept { return static_cast<std::int16_t>(static_cast<std::uint16_t>(number(2))); }
  float f32() noexcept { return std::bit_cast<float>(number(4)); }
  std::string_view text() noexcept {
    const std::size_t length = u8();
    if (length > bytes_.size() - at_) {
      is_short_ = true;
      return {};
    }
    const std::string_view text(reinterpret_cast<const char*>(bytes_.data()) + at_, length);
    at_ += length;
    return text;
  }
  [[nodiscard]] bool is_exactly_read() const noexcept { return !is_short_ && at_ == bytes_.size(); }

 private:
  std::uint32_t number(std::size_t bytes) noexcept {
    if (bytes > bytes_.size() - at_) {
      is_short_ = true;
      at_ = bytes_.size();
      return 0;
    }
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) value |= static_cast<std::uint32_t>(bytes_[at_ + i]) << (8 * i);
    at_ += bytes;
    return value;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool is_short_ = false;
};

tl::unexpected<Refusal> refuse(const char* frame, const char* field, double value, const char* rule, int channel = -1) noexcept {
  return tl::make_unexpected(Refusal{frame, channel, field, value, rule});
}

tl::unexpected<Refusal> refuse_length(const char* frame, std::span<const std::uint8_t> payload) noexcept {
  return tl::make_unexpected(Refusal{.frame = frame,
                                     .field = "length",
                                     .value = static_cast<double>(payload.size()),
                                     .rule = "bytes does not fit the fields",
                                     .is_malformed = true});
}

bool is_printable_ascii(std::string_view text) noexcept {
  return std::ranges::all_of(text, [](char c) { return c >= 0x20 && c < 0x7F; });
}

/// Returns the rule that an identity text breaks; null: none.
const char* broken_rule(std::string_view text) noexcept {
  if (text.size() > 32) return "is longer than 32 bytes";
  return is_printable_ascii(text) ? nullptr : "is not printable ASCII";
}

const char* broken_name_rule(std::string_view text) noexcept {
  if (text.size() > 16) return "is longer than 16 bytes";
  const bool has_control = std::ranges::any_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
  return has_control || !core::is_utf8(text) ? "is not printable UTF-8" : nullptr;
}

}  // namespace

std::uint32_t crc32(std::span<const std::uint8_t> bytes) noexcept {
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

float Channel::value(std::int16_t code) const noexcept { return std::fma(static_cast<float>(code), scale, offset); }

std::string to_string(const Refusal& refusal) {
  std::string text = refusal.frame;
  if (refusal.channel >= 0) text += " " + std::to_string(refusal.channel);
  text += std::string(": ") + refusal.field + " ";
  if (!std::isnan(refusal.value)) text += core::number_text(refusal.value) + " ";
  return text + refusal.rule;
}

Parsed<Descriptor> parse_descriptor(std::span<const std::uint8_t> payload) noexcept {
  constexpr const char* kFrame = "DESCRIPTOR";
  FieldReader fields(payload.subspan(1));
  const std::uint8_t version = fields.u8();
  Descriptor found;
  found.channels = fields.u8();
  found.converter_bits = fields.u8();
  found.rate = {fields.u32(), fields.u32()};
  found.ticks_per_second = fields.u32();
  const std::uint8_t flags = fields.u8();
  const std::string_view serial = fields.text();
  const std::string_view model = fields.text();
  const std::string_view firmware = fields.text();
  if (payload.size() >= 2 && version != kVersion) return refuse(kFrame, "version", version, "is unknown; dtsd knows version 1");
  if (!fields.is_exactly_read()) return refuse_length(kFrame, payload);
  if (found.channels < 1 || found.channels > core::kMaxChannels) {
    return refuse(kFrame, "channels", static_cast<double>(found.channels), "is outside 1 to 32");
  }
  if (found.converter_bits < 1 || found.converter_bits > kMostConverterBits) {
    return refuse(kFrame, "converter bits", found.converter_bits, "is outside 1 to 32");
  }
  if (found.rate.denominator == 0) return refuse(kFrame, "rate denominator", 0.0, "is not allowed");
  const bool is_measured_by_host = found.rate.numerator == 0 && found.rate.denominator == 1;
  const double rate_hz = found.rate.hz();
  if (!is_measured_by_host && (rate_hz < kLowestRateHz || rate_hz > kHighestRateHz)) {
    return refuse(kFrame, "rate", rate_hz, "Hz is outside 1 to 20000 Hz");
  }
  found.carries_time = (flags & 1U) != 0;
  found.starts_on_command = (flags & 2U) != 0;
  found.is_pattern = (flags & 4U) != 0;
  found.is_streaming = (flags & 8U) != 0;
  if (found.carries_time && found.ticks_per_second == 0) {
    return refuse(kFrame, "ticks per second", 0.0, "is not allowed if scans carry time");
  }
  if (const char* const rule = broken_rule(serial)) return refuse(kFrame, "serial", kNoValue, rule);
  if (const char* const rule = broken_rule(model)) return refuse(kFrame, "model", kNoValue, rule);
  if (const char* const rule = broken_rule(firmware)) return refuse(kFrame, "firmware", kNoValue, rule);
  found.serial = ShortText<32>(serial);
  found.model = ShortText<32>(model);
  found.firmware = ShortText<32>(firmware);
  return found;
}

Parsed<Channel> parse_channel(std::span<const std::uint8_t> payload) noexcept {
  constexpr const char* kFrame = "CHANNEL";
  FieldReader fields(payload.subspan(1));
  Channel found;
  found.index = fields.u8();
  const std::uint8_t flags = fields.u8();
  found.is_constant = (flags & 1U) != 0;
  found.is_digital = (flags & 2U) != 0;
  found.lowest = fields.i16();
  found.highest = fields.i16();
  found.scale = fields.f32();
  found.offset = fields.f32();
  const std::string_view name = fields.text();
  const std::string_view unit = fields.text();
  const int index = static_cast<int>(found.index);
  if (!fields.is_exactly_read()) return refuse_length(kFrame, payload);
  if (found.index >= core::kMaxChannels) {
    return tl::make_unexpected(
        Refusal{.frame = kFrame, .field = "index", .value = static_cast<double>(index), .rule = "is not below 32", .is_malformed = true});
  }
  if (!std::isfinite(found.scale)) return refuse(kFrame, "scale", kNoValue, "is not finite", index);
  if (found.scale == 0.0F) return refuse(kFrame, "scale", 0.0, "is not allowed", index);
  if (!std::isfinite(found.offset)) return refuse(kFrame, "offset", kNoValue, "is not finite", index);
  if (found.lowest > found.highest) return refuse(kFrame, "lowest", found.lowest, "is above highest", index);
  if (found.is_constant && found.lowest != found.highest) {
    return refuse(kFrame, "lowest", found.lowest, "is not highest, but the channel is constant", index);
  }
  if (name.empty()) return refuse(kFrame, "name", kNoValue, "is empty", index);
  if (const char* const rule = broken_name_rule(name)) return refuse(kFrame, "name", kNoValue, rule, index);
  if (const char* const rule = broken_name_rule(unit)) return refuse(kFrame, "unit", kNoValue, rule, index);
  found.name = ShortText<16>(name);
  found.unit = ShortText<16>(unit);
  return found;
}

Parsed<Scans> parse_scans(std::span<const std::uint8_t> payload, std::size_t channels) noexcept {
  constexpr const char* kFrame = "SCANS";
  if (payload.size() < kScansHead) return refuse_length(kFrame, payload);
  FieldReader fields(payload.subspan(1));
  Scans found;
  found.run = fields.u8();
  found.counter = fields.u32();
  found.ticks = fields.u32();
  found.count = fields.u8();
  if (found.count == 0) return refuse(kFrame, "count", 0.0, "is not allowed");
  found.codes = payload.subspan(kScansHead);
  if (found.codes.size() != 2 * found.count * channels) return refuse_length(kFrame, payload);
  return found;
}

Parsed<Lost> parse_lost(std::span<const std::uint8_t> payload) noexcept {
  if (payload.size() != kLostLength) return refuse_length("LOST", payload);
  FieldReader fields(payload.subspan(1));
  Lost found;
  found.run = fields.u8();
  found.counter = fields.u32();
  found.reason = fields.u8();
  found.lost = fields.u32();
  return found;
}

Parsed<ShortText<120>> parse_log(std::span<const std::uint8_t> payload) noexcept {
  if (payload.size() > 1 + kMostLogText) return refuse_length("LOG", payload);
  return ShortText<kMostLogText>({reinterpret_cast<const char*>(payload.data()) + 1, payload.size() - 1});
}

EncodedFrame encode_frame(std::span<const std::uint8_t> payload) noexcept {
  std::array<std::uint8_t, kMostPlain> plain{};
  const std::size_t length = std::min(payload.size(), kMostPayload);
  std::copy_n(payload.begin(), length, plain.begin());
  const std::uint32_t crc = crc32(payload.first(length));
  for (std::size_t i = 0; i < kCrcBytes; ++i) plain[length + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  EncodedFrame frame;
  frame.length = stuff({plain.data(), length + kCrcBytes}, frame.bytes);
  frame.bytes[frame.length++] = 0;
  return frame;
}

namespace {

EncodedFrame encode_command(std::span<const std::uint8_t> payload) noexcept {
  const EncodedFrame frame = encode_frame(payload);
  EncodedFrame command;  // its first byte stays 0x00
  command.length = std::min(1 + frame.length, command.bytes.size());
  std::copy_n(frame.bytes.begin(), command.length - 1, command.bytes.begin() + 1);
  return command;
}

}  // namespace

EncodedFrame describe_command() noexcept { return encode_command(std::array{static_cast<std::uint8_t>(FrameType::Describe)}); }

EncodedFrame start_command(WireRate rate) noexcept {
  std::array<std::uint8_t, 9> payload{static_cast<std::uint8_t>(FrameType::Start)};
  for (std::size_t i = 0; i < 4; ++i) {
    payload[1 + i] = static_cast<std::uint8_t>(rate.numerator >> (8 * i));
    payload[5 + i] = static_cast<std::uint8_t>(rate.denominator >> (8 * i));
  }
  return encode_command(payload);
}

EncodedFrame stop_command() noexcept { return encode_command(std::array{static_cast<std::uint8_t>(FrameType::Stop)}); }

EncodedFrame pattern_command(bool is_on) noexcept {
  return encode_command(std::array{static_cast<std::uint8_t>(FrameType::Pattern), static_cast<std::uint8_t>(is_on ? 1 : 0)});
}

}  // namespace dts::device::board
