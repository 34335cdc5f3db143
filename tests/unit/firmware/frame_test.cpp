// SPDX-License-Identifier: Apache-2.0
#include "firmware/frame.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "unit/firmware/frames.h"

namespace firmware::test {
namespace {

using ::testing::ElementsAre;

Bytes taken(ByteRing& ring) {
  Bytes bytes;
  while (!ring.is_empty()) bytes.push_back(ring.take());
  return bytes;
}

TEST(Frame, CrcIsThatOfTheDescription) {
  Crc crc;
  for (const char digit : {'1', '2', '3', '4', '5', '6', '7', '8', '9'}) crc.add(static_cast<uint8_t>(digit));
  EXPECT_EQ(crc.value(), 0xCBF43926U);
}

TEST(Frame, BytesOfAFrameAreThoseOfAnIndependentEncoder) {
  ByteRing ring;
  FrameWriter frame(ring, Type::kLost);
  frame.u8(7);
  frame.u32(0x01020300);
  frame.u8(1);
  frame.u32(5);
  frame.end();
  EXPECT_EQ(taken(ring), encoded({0x04, 7, 0x00, 0x03, 0x02, 0x01, 1, 5, 0, 0, 0}));
}

TEST(Frame, EveryPayloadComesBack) {
  std::mt19937 random(1);
  ByteRing ring;  // one for all: its places wrap
  for (int round = 0; round < 2000; ++round) {
    Bytes payload(1 + random() % kLargestPayload);
    for (uint8_t& byte : payload) byte = random() % 3 == 0 ? uint8_t{0} : static_cast<uint8_t>(random());
    if (round % 5 == 0) std::fill(payload.begin(), payload.end(), uint8_t{0xFF});
    payload[0] = 0x03;
    ASSERT_GE(ring.room(), FrameWriter::size_on_wire(static_cast<uint8_t>(payload.size())));
    FrameWriter frame(ring, Type::kScans);
    for (std::size_t i = 1; i < payload.size(); ++i) frame.u8(payload[i]);
    frame.end();
    const uint8_t used = static_cast<uint8_t>(ByteRing::kCapacity - ring.room());
    EXPECT_EQ(used, FrameWriter::size_on_wire(static_cast<uint8_t>(payload.size())));
    ASSERT_EQ(taken(ring), encoded(payload));
  }
}

TEST(Frame, ReaderSeesNothingBeforeTheEnd) {
  ByteRing ring;
  FrameWriter frame(ring, Type::kLog);
  frame.bytes("hello");
  EXPECT_TRUE(ring.is_empty());
  frame.end();
  EXPECT_FALSE(ring.is_empty());
}

TEST(Frame, ATextIsCutAtItsLimit) {
  ByteRing ring;
  FrameWriter frame(ring, Type::kLog);
  frame.text("abcdef", 4);
  frame.text("", 4);
  frame.end();
  EXPECT_THAT(take_frames(ring).at(0), ElementsAre(0x05, 4, 'a', 'b', 'c', 'd', 0));
}

bool add_all(CommandReader& reader, const Bytes& bytes) {
  bool is_command = false;
  for (const uint8_t byte : bytes) is_command = reader.add(byte);
  return is_command;
}

TEST(CommandReader, ReadsACommand) {
  CommandReader reader;
  ASSERT_TRUE(add_all(reader, encoded({0x82, 0xE8, 0x03, 0, 0, 2, 0, 0, 0})));
  EXPECT_EQ(reader.size(), 9);
  EXPECT_EQ(reader.payload()[0], 0x82);
  EXPECT_EQ(reader.u32(1), 1000U);
  EXPECT_EQ(reader.u32(5), 2U);
}

TEST(CommandReader, SkipsWhatIsTooLongUpToItsZero) {
  CommandReader reader;
  EXPECT_FALSE(add_all(reader, encoded(Bytes(10, 0x83))));  // one byte longer than the longest command
  EXPECT_FALSE(add_all(reader, encoded(Bytes(240, 0x83))));
  Bytes longer = encoded({0x82, 1, 1, 1, 1, 1, 1, 1, 1});
  longer.insert(longer.end() - 1, {1, 2, 3});
  EXPECT_FALSE(add_all(reader, longer)) << "it begins like a good command";
  EXPECT_TRUE(add_all(reader, encoded({0x83})));
}

TEST(CommandReader, EmptyFramesAreNoCommand) {
  CommandReader reader;
  EXPECT_FALSE(add_all(reader, {0, 0, 0}));
  EXPECT_TRUE(add_all(reader, encoded({0x81})));
}

TEST(CommandReader, EveryBitErrorIsRejected) {
  const Bytes good = encoded({0x84, 1});
  for (std::size_t bit = 0; bit < 8 * (good.size() - 1); ++bit) {
    Bytes damaged = good;
    damaged[bit / 8] = static_cast<uint8_t>(damaged[bit / 8] ^ (1U << (bit % 8)));
    CommandReader reader;
    bool is_command = false;
    for (const uint8_t byte : damaged) is_command = reader.add(byte) || is_command;
    EXPECT_FALSE(is_command) << "bit " << bit;
  }
}

TEST(CommandReader, NoiseIsNoCommand) {
  std::mt19937 random(2);
  CommandReader reader;
  int commands = 0;
  for (int i = 0; i < 1'000'000; ++i) commands += reader.add(static_cast<uint8_t>(random() % 4 == 0 ? random() % 8 : random())) ? 1 : 0;
  EXPECT_EQ(commands, 0);
}

}  // namespace
}  // namespace firmware::test
