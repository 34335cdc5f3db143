// SPDX-License-Identifier: Apache-2.0
#include "lab/replay/stream_check.h"

#include <gtest/gtest.h>

namespace dts::lab::replay {
namespace {

TEST(StreamCheck, StreamThatIsNeverRecorded_IsADifferenceBeforeItFillsTheMemory) {
  constexpr std::size_t kScans = 256;
  constexpr std::size_t kBlocks = 20'000;  // 160 MB
  StreamCheck check({.name = "floor/cop", .channels = {{.label = "ml_mm"}, {.label = "ap_mm"}, {.label = "load_n"}, {.label = "more"}}});
  core::Block block(4, kScans);
  block.set_count(kScans);
  std::size_t blocks = 0;
  for (; blocks < kBlocks && !check.difference(); ++blocks) {
    block.first_scan = {blocks * kScans};
    check.add_computed(block);
  }

  ASSERT_TRUE(check.difference());
  EXPECT_LT(blocks, kBlocks);
  EXPECT_EQ(check.difference()->scan, 0U);
  EXPECT_EQ(check.difference()->recorded, "nothing");
}

TEST(StreamCheck, SidesThatTakeTurns_AreComparedHoweverLong) {
  StreamCheck check({.name = "floor/cop", .channels = {{.label = "ml_mm"}}});
  core::Block block(1, 1000);
  block.set_count(1000);
  std::ranges::fill(block.column(0), 0.5);
  for (std::uint64_t first = 0; first < 20'000'000; first += 1000) {
    block.first_scan = {first};
    check.add_computed(block);
    check.add_recorded({.first_scan = {first}, .count = 1000, .values = std::vector<double>(1000, 0.5)});
  }
  check.finish(false);

  EXPECT_FALSE(check.difference());
  EXPECT_EQ(check.compared_scans(), 20'000'000U);
}

}  // namespace
}  // namespace dts::lab::replay
