// SPDX-License-Identifier: Apache-2.0
#include "device/board/frames.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "device/board/board_facts.h"
#include "device/board/cobs.h"

namespace dts::device::board {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// A payload that is written field by field.
struct Wire {
  Bytes bytes;
  Wire& u8(unsigned value) {
    bytes.push_back(static_cast<std::uint8_t>(value));
    return *this;
  }
  Wire& u16(unsigned value) { return u8(value & 0xFFU).u8(value >> 8U); }
  Wire& u32(std::uint32_t value) { return u16(value & 0xFFFFU).u16(value >> 16U); }
  Wire& f32(float value) { return u32(std::bit_cast<std::uint32_t>(value)); }
  Wire& text(const std::string& text) {
    u8(static_cast<unsigned>(text.size()));
    bytes.insert(bytes.end(), text.begin(), text.end());
    return *this;
  }
};

struct DescriptorFields {
  unsigned version = 1;
  unsigned channels = 4;
  unsigned bits = 10;
  std::uint32_t numerator = 1000;
  std::uint32_t denominator = 1;
  std::uint32_t ticks = 1'000'000;
  unsigned flags = 3;
  std::string serial = "S1";
  std::string model = "Uno";
  std::string firmware = "1.2";
  [[nodiscard]] Bytes wire() const {
    Wire wire;
    wire.u8(0x01).u8(version).u8(channels).u8(bits).u32(numerator).u32(denominator).u32(ticks).u8(flags);
    return wire.text(serial).text(model).text(firmware).bytes;
  }
};

struct ChannelFields {
  unsigned index = 2;
  unsigned flags = 0;
  int lowest = 0;
  int highest = 1023;
  float scale = 5.0F / 1023.0F;
  float offset = 0.0F;
  std::string name = "a2";
  std::string unit = "V";
  [[nodiscard]] Bytes wire() const {
    Wire wire;
    wire.u8(0x02).u8(index).u8(flags).u16(static_cast<std::uint16_t>(lowest)).u16(static_cast<std::uint16_t>(highest));
    return wire.f32(scale).f32(offset).text(name).text(unit).bytes;
  }
};

std::string refusal(const DescriptorFields& fields) {
  const auto parsed = parse_descriptor(fields.wire());
  return parsed ? "" : to_string(parsed.error());
}
std::string refusal(const ChannelFields& fields) {
  const auto parsed = parse_channel(fields.wire());
  return parsed ? "" : to_string(parsed.error());
}

TEST(Cobs, AnyFrame_HasNoZeroAndComesBack) {
  rc::check([](const Bytes& any) {
    const std::span<const std::uint8_t> plain = std::span(any).first(std::min(any.size(), kMostPlain));
    std::array<std::uint8_t, kMostStuffed> stuffed{};
    const std::size_t length = stuff(plain, stuffed);
    RC_ASSERT(length == plain.size() + 1);
    for (std::size_t i = 0; i < length; ++i) RC_ASSERT(stuffed[i] != 0);
    std::array<std::uint8_t, kMostStuffed> back{};
    const auto back_length = unstuff(std::span(stuffed).first(length), back);
    RC_ASSERT(back_length.has_value());
    RC_ASSERT(std::ranges::equal(std::span(back).first(*back_length), plain));
  });
}

TEST(Cobs, LongestFrames_ComeBack) {
  for (const std::uint8_t filler : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{255}}) {
    const Bytes plain(kMostPlain, filler);
    std::array<std::uint8_t, kMostStuffed> stuffed{};
    ASSERT_EQ(stuff(plain, stuffed), kMostStuffed);
    std::array<std::uint8_t, kMostStuffed> back{};
    ASSERT_EQ(unstuff(stuffed, back), kMostPlain);
    EXPECT_TRUE(std::ranges::equal(std::span(back).first(kMostPlain), plain));
  }
}

TEST(Cobs, DamagedStuffing_IsRejected) {
  std::array<std::uint8_t, kMostStuffed> out{};
  EXPECT_FALSE(unstuff({}, out));
  EXPECT_FALSE(unstuff(Bytes{0}, out));
  EXPECT_FALSE(unstuff(Bytes{3, 1}, out));     // points beyond the end
  EXPECT_FALSE(unstuff(Bytes{3, 0, 1}, out));  // a zero inside
  EXPECT_FALSE(unstuff(Bytes(kMostStuffed + 1, 1), out));
}

TEST(Frames, Crc_IsThatOfTheSheet) {
  const std::string text = "123456789";
  EXPECT_EQ(crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}), 0xCBF43926U);
}

TEST(Frames, Descriptor_HasItsFields) {
  const auto parsed = parse_descriptor(DescriptorFields{.flags = 1 | 8}.wire());
  ASSERT_TRUE(parsed.has_value());
  EXPECT_EQ(parsed->channels, 4U);
  EXPECT_EQ(parsed->converter_bits, 10U);
  EXPECT_EQ(parsed->rate, (WireRate{1000, 1}));
  EXPECT_EQ(parsed->ticks_per_second, 1'000'000U);
  EXPECT_TRUE(parsed->carries_time);
  EXPECT_FALSE(parsed->starts_on_command);
  EXPECT_FALSE(parsed->is_pattern);
  EXPECT_TRUE(parsed->is_streaming);
  EXPECT_EQ(parsed->serial.view(), "S1");
  EXPECT_EQ(parsed->model.view(), "Uno");
  EXPECT_EQ(parsed->firmware.view(), "1.2");
}

TEST(Frames, Descriptor_EachRejectedFieldIsNamed) {
  EXPECT_EQ(refusal(DescriptorFields{.numerator = 0, .denominator = 1}), "");  // the host measures
  EXPECT_EQ(refusal(DescriptorFields{.numerator = 20'000}), "");
  EXPECT_EQ(refusal(DescriptorFields{.numerator = 0, .denominator = 2}), "DESCRIPTOR: rate 0 Hz is outside 1 to 20000 Hz");
  EXPECT_EQ(refusal(DescriptorFields{.numerator = 1, .denominator = 2}), "DESCRIPTOR: rate 0.5 Hz is outside 1 to 20000 Hz");
  EXPECT_EQ(refusal(DescriptorFields{.numerator = 20'001}), "DESCRIPTOR: rate 20001 Hz is outside 1 to 20000 Hz");
  EXPECT_EQ(refusal(DescriptorFields{.denominator = 0}), "DESCRIPTOR: rate denominator 0 is not allowed");
  EXPECT_EQ(refusal(DescriptorFields{.channels = 0}), "DESCRIPTOR: channels 0 is outside 1 to 32");
  EXPECT_EQ(refusal(DescriptorFields{.channels = 33}), "DESCRIPTOR: channels 33 is outside 1 to 32");
  EXPECT_EQ(refusal(DescriptorFields{.bits = 0}), "DESCRIPTOR: converter bits 0 is outside 1 to 32");
  EXPECT_EQ(refusal(DescriptorFields{.version = 2}), "DESCRIPTOR: version 2 is unknown; dtsd knows version 1");
  EXPECT_EQ(refusal(DescriptorFields{.ticks = 0}), "DESCRIPTOR: ticks per second 0 is not allowed if scans carry time");
  EXPECT_EQ(refusal(DescriptorFields{.ticks = 0, .flags = 2}), "");
  EXPECT_EQ(refusal(DescriptorFields{.serial = std::string(33, 'x')}), "DESCRIPTOR: serial is longer than 32 bytes");
  EXPECT_EQ(refusal(DescriptorFields{.model = "\x1B[2J"}), "DESCRIPTOR: model is not printable ASCII");
}

TEST(Frames, Channel_EachRejectedFieldIsNamed) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(refusal(ChannelFields{}), "");
  EXPECT_EQ(refusal(ChannelFields{.index = 32}), "CHANNEL: index 32 is not below 32");
  EXPECT_EQ(refusal(ChannelFields{.lowest = 5, .highest = 4}), "CHANNEL 2: lowest 5 is above highest");
  EXPECT_EQ(refusal(ChannelFields{.scale = 0.0F}), "CHANNEL 2: scale 0 is not allowed");
  EXPECT_EQ(refusal(ChannelFields{.scale = kInfinity}), "CHANNEL 2: scale is not finite");
  EXPECT_EQ(refusal(ChannelFields{.offset = -kInfinity}), "CHANNEL 2: offset is not finite");
  EXPECT_EQ(refusal(ChannelFields{.offset = std::numeric_limits<float>::quiet_NaN()}), "CHANNEL 2: offset is not finite");
  EXPECT_EQ(refusal(ChannelFields{.name = ""}), "CHANNEL 2: name is empty");
  EXPECT_EQ(refusal(ChannelFields{.name = "12345678901234567"}), "CHANNEL 2: name is longer than 16 bytes");
  EXPECT_EQ(refusal(ChannelFields{.unit = "\xFF"}), "CHANNEL 2: unit is not printable UTF-8");
  EXPECT_EQ(refusal(ChannelFields{.flags = 1}), "CHANNEL 2: lowest 0 is not highest, but the channel is constant");
}

TEST(Frames, AnyOtherLength_IsRejected) {
  const Bytes descriptor = DescriptorFields{}.wire();
  const Bytes channel = ChannelFields{}.wire();
  const Bytes scans = Wire{}.u8(0x03).u8(1).u32(5).u32(6).u8(2).u16(1).u16(2).u16(3).u16(4).bytes;
  const Bytes lost = Wire{}.u8(0x04).u8(1).u32(5).u8(1).u32(9).bytes;
  ASSERT_TRUE(parse_scans(scans, 2).has_value());
  ASSERT_TRUE(parse_lost(lost).has_value());
  for (const Bytes& good : {descriptor, channel, scans, lost}) {
    for (std::size_t length = 1; length <= good.size() + 1; ++length) {
      if (length == good.size()) continue;
      Bytes other = good;
      other.resize(length);
      EXPECT_FALSE(parse_descriptor(other).has_value() && good == descriptor) << length;
      EXPECT_FALSE(parse_channel(other).has_value() && good == channel) << length;
      EXPECT_FALSE(parse_scans(other, 2).has_value()) << length;
      EXPECT_FALSE(parse_lost(other).has_value() && good == lost) << length;
    }
  }
  EXPECT_FALSE(parse_scans(Wire{}.u8(0x03).u8(1).u32(5).u32(6).u8(0).bytes, 2).has_value()) << "no scan";
}

TEST(Frames, AnyBytes_NeitherCrashNorPassWithWrongLength) {
  rc::check([](Bytes any, std::size_t channels) {
    if (any.empty()) any.push_back(0);
    any.resize(std::min(any.size(), kMostPayload));
    (void)parse_descriptor(any);
    (void)parse_channel(any);
    (void)parse_lost(any);
    (void)parse_log(any);
    if (const auto scans = parse_scans(any, channels % 33)) RC_ASSERT(scans->codes.size() == 2 * scans->count * (channels % 33));
  });
}

TEST(Frames, Log_HasAtMost120Bytes) {
  Bytes wire{0x05};
  wire.resize(121, 'x');
  ASSERT_TRUE(parse_log(wire).has_value());
  EXPECT_EQ(parse_log(wire)->view(), std::string(120, 'x'));
  wire.push_back('x');
  ASSERT_FALSE(parse_log(wire).has_value());
  EXPECT_TRUE(parse_log(wire).error().is_malformed);
}

TEST(Frames, Codes_AreSigned) {
  const Bytes wire = Wire{}.u8(0x03).u8(7).u32(0xFFFFFFFF).u32(6).u8(1).u16(0x8000).u16(0xFFFF).bytes;
  const auto scans = parse_scans(wire, 2);
  ASSERT_TRUE(scans.has_value());
  EXPECT_EQ(scans->run, 7);
  EXPECT_EQ(scans->counter, 0xFFFFFFFFU);
  EXPECT_EQ(scans->code(0), -32768);
  EXPECT_EQ(scans->code(1), -1);
}

TEST(Frames, Value_IsRoundedOnceToAFloat) {
  rc::check([](std::int16_t code, float scale, float offset) {
    Channel channel;
    channel.scale = scale;
    channel.offset = offset;
    const long double exact = static_cast<long double>(code) * scale + offset;  // 64 bits: exact unless the sizes differ much
    const float value = channel.value(code);
    if (!std::isfinite(value)) return;
    const auto next = std::nextafter(value, std::numeric_limits<float>::infinity());
    const auto before = std::nextafter(value, -std::numeric_limits<float>::infinity());
    RC_ASSERT(std::abs(exact - value) <= std::abs(exact - next) && std::abs(exact - value) <= std::abs(exact - before));
  });
}

TEST(Frames, Commands_AreThoseOfTheSheet) {
  EXPECT_EQ(start_command({1000, 3}).view().back(), 0);
  EXPECT_EQ(start_command({1000, 3}).view().front(), 0) << "ends what came before";
  std::array<std::uint8_t, kMostStuffed> plain{};
  const auto command = start_command({1000, 3});
  const auto length = unstuff(command.view().subspan(1, command.length - 2), plain);
  ASSERT_EQ(length, 9U + kCrcBytes);
  EXPECT_TRUE(std::ranges::equal(std::span(plain).first(9), Wire{}.u8(0x82).u32(1000).u32(3).bytes));
}

TEST(BoardFacts, Complete_WhenAllChannelsAreKnown) {
  BoardFacts facts;
  EXPECT_EQ(facts.add(*parse_descriptor(DescriptorFields{.channels = 2}.wire())), BoardFacts::Change::Learned);
  EXPECT_EQ(facts.add(*parse_channel(ChannelFields{.index = 0, .name = "a"}.wire())), BoardFacts::Change::Learned);
  EXPECT_FALSE(facts.is_complete());
  EXPECT_EQ(facts.add(*parse_channel(ChannelFields{.index = 1, .name = "b"}.wire())), BoardFacts::Change::Learned);
  EXPECT_TRUE(facts.is_complete());
  EXPECT_EQ(facts.add(*parse_channel(ChannelFields{.index = 1, .name = "b"}.wire())), BoardFacts::Change::None);
  EXPECT_EQ(facts.add(*parse_descriptor(DescriptorFields{.channels = 2, .numerator = 500, .flags = 8 | 3}.wire())),
            BoardFacts::Change::None);
  EXPECT_TRUE(facts.is_complete());
}

TEST(BoardFacts, AnotherDescription_ForgetsTheFirst) {
  BoardFacts facts;
  facts.add(*parse_descriptor(DescriptorFields{.channels = 1}.wire()));
  (void)facts.add(*parse_channel(ChannelFields{.index = 0}.wire()));
  ASSERT_TRUE(facts.is_complete());
  EXPECT_EQ(facts.add(*parse_channel(ChannelFields{.index = 0, .scale = 2.0F}.wire())), BoardFacts::Change::Another);
  EXPECT_TRUE(facts.is_complete());
  EXPECT_EQ(facts.add(*parse_descriptor(DescriptorFields{.channels = 1, .serial = "S2"}.wire())), BoardFacts::Change::Another);
  EXPECT_FALSE(facts.is_complete());
}

TEST(BoardFacts, Agreement_EndsWithEveryContradiction) {
  BoardFacts facts;
  const auto descriptor = *parse_descriptor(DescriptorFields{.channels = 1}.wire());
  const auto channel = *parse_channel(ChannelFields{.index = 0}.wire());
  facts.add(descriptor);
  (void)facts.add(channel);
  EXPECT_FALSE(facts.is_agreed());
  facts.agree();
  facts.add(descriptor);
  (void)facts.add(channel);
  EXPECT_TRUE(facts.is_agreed()) << "the same again";
  (void)facts.add(*parse_channel(ChannelFields{.index = 0, .scale = 2.0F}.wire()));
  EXPECT_FALSE(facts.is_agreed());
  facts.agree();
  facts.add(*parse_descriptor(DescriptorFields{.channels = 1, .serial = "S2"}.wire()));
  EXPECT_FALSE(facts.is_agreed());
  facts.agree();
  facts.doubt();
  EXPECT_FALSE(facts.is_agreed());
}

TEST(BoardFacts, NameTwice_AndIndexBeyondTheChannels_AreRejected) {
  BoardFacts facts;
  facts.add(*parse_descriptor(DescriptorFields{.channels = 2}.wire()));
  (void)facts.add(*parse_channel(ChannelFields{.index = 0, .name = "a"}.wire()));
  const auto twice = facts.add(*parse_channel(ChannelFields{.index = 1, .name = "a"}.wire()));
  ASSERT_FALSE(twice.has_value());
  EXPECT_EQ(to_string(twice.error()), "CHANNEL 1: name occurs twice");
  EXPECT_FALSE(facts.add(*parse_channel(ChannelFields{.index = 2, .name = "c"}.wire())).has_value());
  EXPECT_FALSE(facts.is_complete());
}

}  // namespace
}  // namespace dts::device::board
