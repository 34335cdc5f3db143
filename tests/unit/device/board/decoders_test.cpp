// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "device/board/frame_decoder.h"
#include "device/board/frames.h"
#include "device/board/line_decoder.h"

namespace dts::device::board {
namespace {

using Bytes = std::vector<std::uint8_t>;

void append(Bytes& to, std::span<const std::uint8_t> bytes) { to.insert(to.end(), bytes.begin(), bytes.end()); }

std::vector<Bytes> frames_of(FrameDecoder& decoder, std::span<const std::uint8_t> bytes) {
  std::vector<Bytes> found;
  while (!bytes.empty()) {
    const FrameDecoder::Taken taken = decoder.take(bytes);
    if (taken.has_piece()) found.emplace_back(taken.payload.begin(), taken.payload.end());
    bytes = bytes.subspan(taken.used);
  }
  return found;
}

TEST(FrameDecoder, AnyPayloadsInAnyPieces_ComeBack) {
  rc::check([](std::vector<Bytes> payloads, const std::vector<std::uint8_t>& cuts) {
    std::erase_if(payloads, [](const Bytes& payload) { return payload.empty(); });
    Bytes wire;
    for (Bytes& payload : payloads) {
      payload.resize(std::min(payload.size(), kMostPayload));
      append(wire, encode_frame(payload).view());
    }
    FrameDecoder decoder;
    std::vector<Bytes> found;
    std::span<const std::uint8_t> rest = wire;
    for (std::size_t i = 0; !rest.empty(); ++i) {
      const std::size_t length = std::min<std::size_t>(rest.size(), i < cuts.size() ? 1 + cuts[i] % 40U : rest.size());
      for (Bytes& frame : frames_of(decoder, rest.first(length))) found.push_back(std::move(frame));
      rest = rest.subspan(length);
    }
    RC_ASSERT(found == payloads);
    RC_ASSERT(decoder.counts().good == payloads.size());
    RC_ASSERT(decoder.counts().damaged == 0U);
  });
}

TEST(FrameDecoder, DamagedFrame_IsDroppedAndCountedAndTheNextOneFound) {
  const Bytes payload(100, 7);
  const EncodedFrame frame = encode_frame(payload);
  for (std::size_t at = 0; at + 1 < frame.length; ++at) {  // not the 0x00: without it two frames are lost
    for (unsigned bit = 0; bit < 8; ++bit) {
      Bytes wire{0};
      append(wire, frame.view());
      wire[1 + at] = static_cast<std::uint8_t>(wire[1 + at] ^ (1U << bit));
      append(wire, frame.view());
      FrameDecoder decoder;
      ASSERT_EQ(frames_of(decoder, wire), std::vector<Bytes>{payload}) << at << " " << bit;
      ASSERT_GE(decoder.counts().damaged, 1U);
    }
  }
}

TEST(FrameDecoder, EmptyFrames_AreNoError) {
  FrameDecoder decoder;
  Bytes wire(10, 0);
  append(wire, encode_frame(Bytes{1}).view());
  EXPECT_EQ(frames_of(decoder, wire), std::vector<Bytes>{Bytes{1}});
  EXPECT_EQ(decoder.counts().damaged + decoder.counts().too_long, 0U);
}

TEST(FrameDecoder, TooLongFrame_IsSkippedToItsEnd) {
  FrameDecoder decoder;
  Bytes wire{0};
  wire.insert(wire.end(), 10'000, 0x55);
  wire.push_back(0);
  append(wire, encode_frame(Bytes{1}).view());
  EXPECT_EQ(frames_of(decoder, wire), std::vector<Bytes>{Bytes{1}});
  EXPECT_EQ(decoder.counts().too_long, 1U);
}

TEST(FrameDecoder, FirstFrameCut_IsNotCountedAsDamage) {
  FrameDecoder decoder;
  const EncodedFrame frame = encode_frame(Bytes(50, 3));
  Bytes wire;
  append(wire, frame.view().subspan(20));
  append(wire, frame.view());
  EXPECT_EQ(frames_of(decoder, wire).size(), 1U);
  EXPECT_EQ(decoder.counts().damaged, 0U);
}

TEST(FrameDecoder, TenThousandWrongBaudRates_GiveNoFrame) {
  RecordProperty("requirement", "ACQ-14");
  std::mt19937 random(1);
  FrameDecoder decoder;
  for (int i = 0; i < 10'000; ++i) {
    Bytes garbage(64);
    for (std::uint8_t& byte : garbage) byte = static_cast<std::uint8_t>(random() % 4 == 0 ? 0 : random());
    ASSERT_TRUE(frames_of(decoder, garbage).empty()) << i;
  }
  EXPECT_GT(decoder.counts().damaged, 10'000U);
}

/// Each good line as its numbers, each bad one as "bad".
std::vector<std::string> lines_of(LineDecoder& decoder, std::string_view text, std::size_t channels) {
  std::vector<std::string> found;
  std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  while (!bytes.empty()) {
    const LineDecoder::Taken taken = decoder.take(bytes);
    bytes = bytes.subspan(taken.used);
    if (!taken.is_line) continue;
    std::string numbers = taken.is_good ? std::to_string(decoder.line().position) : "bad";
    for (std::size_t i = 0; i < channels && taken.is_good; ++i) {
      std::array<char, 32> number{};
      std::snprintf(number.data(), number.size(), " %g", decoder.line().values[i]);
      numbers += number.data();
    }
    found.push_back(numbers);
  }
  return found;
}

using Lines = std::vector<std::string>;

Lines read(std::string_view text, FirstColumn first = FirstColumn::Value, unsigned bits = 32, std::size_t channels = 2) {
  LineDecoder decoder(channels, first, bits);
  return lines_of(decoder, "cut\n" + std::string(text), channels);
}

TEST(LineDecoder, CommaTabOrBlank_LfOrCrlf) {
  EXPECT_EQ(read("1.5,2\n1.5\t2\r\n1.5 2\n 1.5 ,  2 \n+1.5,-2e3\n\n\r\n"),
            (Lines{"0 1.5 2", "0 1.5 2", "0 1.5 2", "0 1.5 2", "0 1.5 -2000"}));
}

TEST(LineDecoder, WrongColumnsOrNoNumbers_AreBad) {
  for (const char* bad :
       {"1", "1,2,3", "1,,2", "1,", ",1", "a,2", "1.5.5,2", "nan,1", "inf,1", "1e999,1", "0x10,1", "1,2x", "--1,2", "+-1,2"}) {
    EXPECT_EQ(read(std::string(bad) + "\n"), Lines{"bad"}) << bad;
  }
}

TEST(LineDecoder, FirstLine_IsDropped) {
  LineDecoder decoder(1, FirstColumn::Value, 32);
  EXPECT_EQ(lines_of(decoder, "7\n8\n", 1), Lines{"0 8"});
  decoder.restart();
  EXPECT_EQ(lines_of(decoder, "9\n10\n", 1), Lines{"0 10"});
}

TEST(LineDecoder, CounterAndTime_AreWholeNumbers) {
  EXPECT_EQ(read("65535,1,2\n65536,1,2\n-1,1,2\n1.5,1,2\n", FirstColumn::Counter, 16), (Lines{"65535 1 2", "bad", "bad", "bad"}));
  EXPECT_EQ(read("4294967295,1,2\n4294967296,1,2\n", FirstColumn::TimeUs), (Lines{"4294967295 1 2", "bad"}));
}

TEST(LineDecoder, Checksum_IsCheckedAndNeededAfterTheFirst) {
  // '1' ^ ',' ^ '2' = 0x2F
  EXPECT_EQ(read("1,2\n1,2*2F\n1,2*2f\n1,2*2E\n1,2\n1,2*2\n1,2*2FF\n1,3*2F\n"),
            (Lines{"0 1 2", "0 1 2", "0 1 2", "bad", "bad", "bad", "bad", "bad"}));
}

TEST(LineDecoder, LongestLine_Is512Bytes) {
  const std::string filler(kMostLine - 3, ' ');
  EXPECT_EQ(read("1 " + filler + "2\n"), Lines{"0 1 2"});
  EXPECT_EQ(read("1 " + filler + "2\r\n"), Lines{"0 1 2"});
  EXPECT_EQ(read("1  " + filler + "2\n3,4\n"), (Lines{"bad", "0 3 4"}));
  EXPECT_EQ(read(std::string(5000, '1') + "\n3,4\n"), (Lines{"bad", "0 3 4"}));
}

TEST(LineDecoder, AnyBytes_InAnyPieces_GiveTheSameLines) {
  rc::check([](const std::string& text) {
    LineDecoder at_once(2, FirstColumn::Value, 32);
    LineDecoder by_bytes(2, FirstColumn::Value, 32);
    const Lines expected = lines_of(at_once, text, 2);
    Lines found;
    for (const char c : text) {
      for (std::string& line : lines_of(by_bytes, {&c, 1}, 2)) found.push_back(std::move(line));
    }
    RC_ASSERT(found == expected);
  });
}

}  // namespace
}  // namespace dts::device::board
