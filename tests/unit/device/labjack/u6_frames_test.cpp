// SPDX-License-Identifier: Apache-2.0
// Checksums and refusals; whole commands are in conversations/u6.txt.
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
  for (const auto& [error, meaning] : {std::pair{48, "a stream is running"},
                                       {49, "stream table invalid"},
                                       {50, "stream configuration invalid"},
                                       {52, "no stream is running"},
                                       {54, "converter buffer overflow"},
                                       {55, "scans overlap: too fast for these channels"},
                                       {56, "samples per packet invalid"},
                                       {58, "scan rate invalid"},
                                       {57, "see the U6 data sheet, section 5.3"}}) {
    const core::Error told = refused("StreamConfig", static_cast<std::uint8_t>(error));
    EXPECT_EQ(told.what, "LabJack U6: StreamConfig was rejected with error " + std::to_string(error) + " (" + meaning + ")");
    EXPECT_EQ(told.code, core::ErrorCode::Failed);
  }
}

}  // namespace
}  // namespace dts::device::labjack
