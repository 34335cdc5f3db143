// SPDX-License-Identifier: Apache-2.0
#include "core/block.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/frame.h"

namespace dts::core {
namespace {

TEST(Block, Constructed_IsEmptyWithItsMemoryTaken) {
  Block block(3, 8);

  EXPECT_EQ(block.count(), 0U);
  EXPECT_TRUE(block.column(2).empty());
  block.set_count(8);
  for (std::size_t channel = 0; channel < 3; ++channel) {
    EXPECT_EQ(std::ranges::count(block.column(channel), 0.0), 8);
    EXPECT_EQ(std::ranges::count(block.quality(channel), 0), 8);
  }
}

TEST(Block, Columns_DoNotOverlap) {
  Block block(2, 4);
  block.set_count(4);

  std::ranges::fill(block.column(0), 1.0);
  std::ranges::fill(block.column(1), 2.0);
  std::ranges::fill(block.quality(0), quality::kRail);

  EXPECT_EQ(std::ranges::count(block.column(0), 1.0), 4);
  EXPECT_EQ(std::ranges::count(block.column(1), 2.0), 4);
  EXPECT_EQ(std::ranges::count(block.quality(1), 0), 4);
}

TEST(Block, SmallerCount_ShowsTheFrontOfWhatWasThere) {
  Block block(1, 4);
  block.set_count(4);
  std::ranges::copy(std::array{1.0, 2.0, 3.0, 4.0}, block.column(0).begin());

  block.set_count(2);

  ASSERT_EQ(block.column(0).size(), 2U);
  EXPECT_EQ(block.column(0)[1], 2.0);
}

TEST(Block, CountAboveCapacity_IsCut) {
  Block block(2, 4);

  block.set_count(5);

  EXPECT_EQ(block.count(), 4U);
  EXPECT_EQ(block.column(1).size(), 4U);
  EXPECT_EQ(block.quality(1).size(), 4U);
}

TEST(Block, CopyPosition_TakesTheAxisButNotValuesOrSequence) {
  Block from(1, 4);
  from.segment = 2;
  from.first_scan = {1000};
  from.host_time_ns = 77;
  from.sequence = 9;
  from.set_count(3);
  Block to(2, 4);
  to.sequence = 5;

  to.copy_position(from);

  EXPECT_EQ(to.segment, 2U);
  EXPECT_EQ(to.first_scan, ScanIndex{1000});
  EXPECT_EQ(to.host_time_ns, 77);
  EXPECT_EQ(to.count(), 3U);
  EXPECT_EQ(to.sequence, 5U);
}

TEST(Block, CopyPositionOfLargerBlock_IsCutToItsOwnCapacity) {
  Block from(1, 8);
  from.set_count(8);
  Block to(1, 4);

  to.copy_position(from);

  EXPECT_EQ(to.count(), 4U);
}

// Each doubt is one bit of one byte; the wire format counts on it.
TEST(Quality, Bits_AreDistinct) {
  const std::uint8_t all = quality::kRail | quality::kStuck | quality::kOutOfRange | quality::kRotation | quality::kNoContact |
                           quality::kUncalibrated | quality::kUntared;

  EXPECT_EQ(all, 0x7F);
}

}  // namespace
}  // namespace dts::core
