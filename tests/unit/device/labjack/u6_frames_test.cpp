// SPDX-License-Identifier: Apache-2.0
// Bytes computed by hand from the U6 data sheet's rules.
#include "device/labjack/u6_frames.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

namespace dts::device::labjack {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(U6Frames, Checksum8_FoldsTwice) {
  EXPECT_EQ(checksum8(std::array<std::uint8_t, 1>{0xA8}), 0xA8);
  EXPECT_EQ(checksum8(std::array<std::uint8_t, 2>{0xF8, 0x30}), 0x29);        // 0x128: 1 + 0x28
  EXPECT_EQ(checksum8(std::array<std::uint8_t, 3>{0xFF, 0xFF, 0x01}), 0x01);  // 0x1FF: 1 + 0xFF = 0x100: 1 + 0
}

TEST(U6Frames, Checksum16_IsThePlainSum) {
  const Bytes bytes(300, 0xFF);
  EXPECT_EQ(checksum16(bytes), (300 * 255) & 0xFFFF);
}

TEST(U6Frames, NormalCommands_AreTwiceTheSameByte) {
  EXPECT_EQ(start_stream().bytes, (Bytes{0xA8, 0xA8}));
  EXPECT_EQ(stop_stream().bytes, (Bytes{0xB0, 0xB0}));
  EXPECT_EQ(start_stream().reply_code, 0xA9);
  EXPECT_EQ(stop_stream().reply_code, 0xB1);
}

TEST(U6Frames, ReadUnit_ChangesNothing) {
  Bytes expected(26, 0);
  expected[0] = 0x0B;
  expected[1] = 0xF8;
  expected[2] = 0x0A;
  expected[3] = 0x08;
  EXPECT_EQ(read_unit().bytes, expected);
  EXPECT_EQ(read_unit().reply_bytes, 38U);
}

TEST(U6Frames, ReadCalibration_CarriesTheBlock) {
  EXPECT_EQ(read_calibration(2).bytes, (Bytes{0x29, 0xF8, 0x01, 0x2D, 0x02, 0x00, 0x00, 0x02}));
}

TEST(U6Frames, TimersOff_SaysThatItIsMeant) {
  Bytes expected(16, 0);
  expected[0] = 0x0A;
  expected[1] = 0xF8;
  expected[2] = 0x05;
  expected[3] = 0x0B;
  expected[4] = 0x01;
  expected[6] = 0x01;
  EXPECT_EQ(turn_timers_off().bytes, expected);
}

TEST(U6Frames, StreamConfig_FourChannelsAt100Hz) {
  const StreamSetup setup{
      .samples_per_packet = 4, .scan_config = 0, .interval = 40'000, .channels = {0, 1, 2, 15}, .options = {0, 0, 0x10, 0}};

  EXPECT_EQ(configure_stream(setup).bytes, (Bytes{0x1A, 0xF8, 0x08, 0x11, 0x07, 0x01, 0x04, 0x01, 0x04, 0x00, 0x00,
                                                  0x00, 0x40, 0x9C, 0x00, 0x00, 0x01, 0x00, 0x02, 0x10, 0x0F, 0x00}));
}

TEST(U6Frames, RightChecksums_AnyChangedByteIsFound) {
  const Bytes right = read_calibration(2).bytes;
  ASSERT_TRUE(has_right_checksums(right));
  for (std::size_t at = 0; at < right.size(); ++at) {
    Bytes wrong = right;
    wrong[at] = static_cast<std::uint8_t>(wrong[at] + 1);
    EXPECT_FALSE(has_right_checksums(wrong)) << at;
  }
}

TEST(U6Frames, Refusal_NamesCommandNumberAndMeaning) {
  const core::Error error = refused("StreamConfig", 48);
  EXPECT_NE(error.what.find("StreamConfig"), std::string::npos);
  EXPECT_NE(error.what.find("48"), std::string::npos);
  EXPECT_NE(error.what.find("a stream is running"), std::string::npos);
}

}  // namespace
}  // namespace dts::device::labjack
