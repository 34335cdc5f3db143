// SPDX-License-Identifier: Apache-2.0
#include "device/labjack/u6_stream.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <numeric>
#include <vector>

namespace dts::device::labjack {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Codes = std::vector<std::uint16_t>;
using core::GapReason;

constexpr std::uint16_t kDummy = 0xFFFF;

/// Puts both checksums in place, in other words than the code under test.
Bytes sealed(Bytes packet) {
  const int sum16 = std::accumulate(packet.begin() + 6, packet.end(), 0);
  packet[4] = static_cast<std::uint8_t>(sum16 % 256);
  packet[5] = static_cast<std::uint8_t>(sum16 / 256);
  int sum8 = std::accumulate(packet.begin() + 1, packet.begin() + 6, 0);
  while (sum8 > 255) sum8 = sum8 % 256 + sum8 / 256;
  packet[0] = static_cast<std::uint8_t>(sum8);
  return packet;
}

Bytes packet(std::uint8_t counter, const Codes& samples, std::uint8_t error = 0, std::uint32_t discarded = 0) {
  Bytes bytes(14 + 2 * samples.size());
  bytes[1] = 0xF9;
  bytes[2] = static_cast<std::uint8_t>(4 + samples.size());
  bytes[3] = 0xC0;
  for (unsigned i = 0; i < 4; ++i) bytes[6 + i] = static_cast<std::uint8_t>(discarded >> (8U * i));
  bytes[10] = counter;
  bytes[11] = error;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    bytes[12 + 2 * i] = static_cast<std::uint8_t>(samples[i] % 256);
    bytes[13 + 2 * i] = static_cast<std::uint8_t>(samples[i] / 256);
  }
  return sealed(bytes);
}

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

struct Outcome {
  Codes codes;
  std::vector<std::size_t> faults_at;  ///< Number of codes before each.
  std::vector<usb::Unpacked> faults;
};

/// Feeds all bytes as UsbDaq does, `room` codes at a time.
Outcome feed(StreamParser& parser, const Bytes& bytes, std::size_t room = 1000) {
  Outcome outcome;
  Codes buffer(room);
  std::size_t used = 0;
  for (int i = 0; used < bytes.size() && i < 10'000; ++i) {
    const usb::Unpacked unpacked = parser.unpack(std::span(bytes).subspan(used), buffer);
    used += unpacked.bytes;
    outcome.codes.insert(outcome.codes.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(unpacked.codes));
    if (unpacked.fault == GapReason::None) continue;
    outcome.faults_at.push_back(outcome.codes.size());
    outcome.faults.push_back(unpacked);
    if (!unpacked.goes_on) break;
  }
  return outcome;
}

TEST(U6Stream, PacketByHandThenOthers_CounterWraps) {
  StreamParser parser;
  parser.restart(1, 1);
  const Outcome by_hand = feed(parser, {0x2D, 0xF9, 0x05, 0xC0, 0x6D, 0x00, 0, 0, 0, 0, 0x07, 0x00, 0x34, 0x12, 0x20, 0x00});
  EXPECT_EQ(by_hand.codes, (Codes{0x1234}));
  EXPECT_TRUE(by_hand.faults.empty());

  parser.restart(2, 2);
  const Outcome outcome = feed(parser, packet(254, {1, 2}) + packet(255, {3, 4}) + packet(0, {5, 6}));
  EXPECT_EQ(outcome.codes, (Codes{1, 2, 3, 4, 5, 6}));
  EXPECT_TRUE(outcome.faults.empty());
}

TEST(U6Stream, PacketAcrossTwoTransfersAndLittleRoom_IsPutTogether) {
  const Bytes bytes = packet(0, {1, 2, 3}) + packet(1, {4, 5, 6});
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    for (std::size_t room = 1; room < 8; ++room) {
      StreamParser parser;
      parser.restart(1, 3);
      const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(cut);
      Outcome first = feed(parser, {bytes.begin(), middle}, room);
      const Outcome second = feed(parser, {middle, bytes.end()}, room);
      first.codes.insert(first.codes.end(), second.codes.begin(), second.codes.end());
      EXPECT_EQ(first.codes, (Codes{1, 2, 3, 4, 5, 6})) << cut << ", " << room;
      EXPECT_TRUE(first.faults.empty() && second.faults.empty()) << cut;
    }
  }
}

TEST(U6Stream, AnyByteHeaderOrCounterWrong_Integrity) {
  const Bytes sound = packet(1, {10, 20, 30});
  std::vector<Bytes> all_wrong;
  for (std::size_t at = 0; at < sound.size(); ++at) {
    all_wrong.push_back(sound);
    all_wrong.back()[at] = static_cast<std::uint8_t>(sound[at] ^ 0x10);
  }
  for (const std::size_t at : {1U, 2U, 3U}) {  // a header of another shape, though sealed
    Bytes wrong = sound;
    ++wrong[at];
    all_wrong.push_back(sealed(wrong));
  }
  for (const std::uint8_t counter : {std::uint8_t{0}, std::uint8_t{2}, std::uint8_t{255}})
    all_wrong.push_back(packet(counter, {10, 20, 30}));
  for (std::size_t i = 0; i < all_wrong.size(); ++i) {
    StreamParser parser;
    parser.restart(1, 3);
    const Outcome outcome = feed(parser, packet(0, {1, 2, 3}) + all_wrong[i]);
    ASSERT_EQ(outcome.faults.size(), 1U) << i;
    EXPECT_EQ(outcome.faults[0].fault, GapReason::Integrity) << i;
    EXPECT_FALSE(outcome.faults[0].goes_on);
    EXPECT_EQ(outcome.codes, (Codes{1, 2, 3})) << i;
  }
}

TEST(U6Stream, ErrorNumbers_EndTheStream) {
  const std::array<std::pair<std::uint8_t, GapReason>, 5> cases = {{{54, GapReason::Overrun},
                                                                    {55, GapReason::Overrun},
                                                                    {63, GapReason::Overrun},
                                                                    {48, GapReason::Integrity},
                                                                    {255, GapReason::Integrity}}};
  for (const auto& [error, reason] : cases) {
    StreamParser parser;
    parser.restart(1, 1);
    const Outcome outcome = feed(parser, packet(0, {1}) + packet(1, {2}, error));
    ASSERT_EQ(outcome.faults.size(), 1U) << int{error};
    EXPECT_EQ(outcome.faults[0].fault, reason) << int{error};
    EXPECT_FALSE(outcome.faults[0].goes_on) << int{error};
    EXPECT_EQ(outcome.codes, (Codes{1})) << int{error};
  }
}

TEST(U6Stream, Recovery_OldScansGapNewScans) {
  StreamParser parser;
  parser.restart(2, 5);
  EXPECT_FALSE(parser.is_recovering());
  (void)feed(parser, packet(0, {1, 2, 3, 4, 5}, 59));
  EXPECT_TRUE(parser.is_recovering());

  const Outcome outcome = feed(parser, packet(1, {6, kDummy, kDummy, 7, 8}, 60, 321) + packet(2, {9, 10, 11, 12, 13}));

  EXPECT_FALSE(parser.is_recovering());
  EXPECT_EQ(outcome.codes, (Codes{6, 7, 8, 9, 10, 11, 12, 13}));
  ASSERT_EQ(outcome.faults.size(), 1U);
  EXPECT_EQ(outcome.faults_at[0], 1U);
  EXPECT_EQ(outcome.faults[0].fault, GapReason::Overrun);
  EXPECT_TRUE(outcome.faults[0].goes_on);
  EXPECT_EQ(outcome.faults[0].discarded_scans, 321U);
}

TEST(U6Stream, Recovery_AnyPlaceAndRoom) {
  constexpr std::size_t kSamples = 5;
  for (std::size_t step = 0; step < 4 * 5; ++step) {
    const std::size_t channels = std::array<std::size_t, 4>{3, 1, 2, 7}[step / 5];
    const std::size_t old_scans = step % 5;
    Codes all;
    for (std::size_t i = 0; i < old_scans * channels; ++i) all.push_back(static_cast<std::uint16_t>(100 + i));
    const std::size_t dummy_packet = all.size() / kSamples;
    all.insert(all.end(), channels, kDummy);
    while (all.size() < 8 * kSamples) all.push_back(static_cast<std::uint16_t>(200 + all.size()));
    Bytes bytes;
    for (std::size_t p = 0; p < 8; ++p) {
      const Codes samples(all.begin() + static_cast<std::ptrdiff_t>(p * kSamples),
                          all.begin() + static_cast<std::ptrdiff_t>((p + 1) * kSamples));
      const std::uint8_t error = p < dummy_packet ? 59 : p == dummy_packet ? 60 : 0;
      bytes = bytes + packet(static_cast<std::uint8_t>(p), samples, error, p == dummy_packet ? 7 : 0);
    }
    Codes expected = all;
    expected.erase(expected.begin() + static_cast<std::ptrdiff_t>(old_scans * channels),
                   expected.begin() + static_cast<std::ptrdiff_t>((old_scans + 1) * channels));
    for (std::size_t room = 1; room < 12; ++room) {
      StreamParser parser;
      parser.restart(channels, kSamples);
      const Outcome outcome = feed(parser, bytes, room);
      EXPECT_EQ(outcome.codes, expected) << old_scans << " " << room;
      ASSERT_EQ(outcome.faults.size(), 1U) << old_scans << " " << room;
      EXPECT_EQ(outcome.faults_at[0], old_scans * channels) << room;
      EXPECT_EQ(outcome.faults[0].discarded_scans, 7U);
    }
  }
}

TEST(U6Stream, RailedChannels_AreNoDummyScan) {
  StreamParser parser;
  parser.restart(2, 6);
  // Both neighbours of the border between two scans are railed, and no whole scan but the real dummy is.
  const Outcome outcome = feed(parser, packet(0, {1, kDummy, kDummy, 2, kDummy, kDummy}, 60, 5));
  EXPECT_EQ(outcome.codes, (Codes{1, kDummy, kDummy, 2}));
  ASSERT_EQ(outcome.faults.size(), 1U);
  EXPECT_EQ(outcome.faults_at[0], 4U);
}

TEST(U6Stream, RecoveryThatCannotBeBelieved_EndsTheStream) {
  const std::array<Bytes, 3> cases = {packet(0, {kDummy, kDummy, 1, 2}, 60, 0), packet(0, {kDummy, kDummy, 1, 2}, 60, 0x10005),
                                      packet(0, {1, 2, 3, 4}, 60, 5)};
  for (std::size_t i = 0; i < cases.size(); ++i) {
    StreamParser parser;
    parser.restart(2, 4);
    const Outcome outcome = feed(parser, cases[i]);
    ASSERT_EQ(outcome.faults.size(), 1U) << i;
    EXPECT_EQ(outcome.faults[0].fault, GapReason::Overrun) << i;
    EXPECT_FALSE(outcome.faults[0].goes_on) << i;
    EXPECT_TRUE(outcome.codes.empty()) << i;
  }
}

TEST(U6Stream, DummyScanThatDoesNotContinue_Integrity) {
  StreamParser parser;
  parser.restart(3, 2);
  const Outcome outcome = feed(parser, packet(0, {kDummy, kDummy}, 60, 5) + packet(1, {1, 2}));
  ASSERT_EQ(outcome.faults.size(), 2U);
  EXPECT_TRUE(outcome.faults[0].goes_on);
  EXPECT_EQ(outcome.faults[1].fault, GapReason::Integrity);
}

TEST(U6Stream, Restart_ForgetsEverything) {
  StreamParser parser;
  parser.restart(2, 2);
  Bytes half = packet(9, {1, 2});
  half.resize(7);
  (void)feed(parser, packet(8, {1, 2}, 59) + half);
  parser.restart(1, 3);
  EXPECT_FALSE(parser.is_recovering());
  EXPECT_EQ(feed(parser, packet(77, {4, 5, 6})).codes, (Codes{4, 5, 6}));

  parser.restart(3, 2);
  (void)feed(parser, packet(0, {1, 2}));  // in the middle of a scan
  parser.restart(3, 3);
  const Outcome dummy = feed(parser, packet(0, {kDummy, kDummy, kDummy}, 60, 4));
  EXPECT_TRUE(dummy.codes.empty());
  EXPECT_EQ(dummy.faults.size(), 1U);
}

}  // namespace
}  // namespace dts::device::labjack
