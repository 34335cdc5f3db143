// SPDX-License-Identifier: Apache-2.0
#include "../clients/libdts/loss_tracker.h"

#include <gtest/gtest.h>

namespace dts::client {
namespace {

ScanGap gap_between(const Position& first, const Position& second) {
  LossTracker tracker;
  EXPECT_EQ(tracker.advance(first).scans, 0U);
  return tracker.advance(second);
}

TEST(LossTracker, GapBetweenTwoBlocks_IsCountedInScans) {
  RecordProperty("requirement", "PUB-2");
  struct Row {
    Position first;
    Position second;
    std::uint64_t scans;
    bool is_exact;
  };
  for (const Row& row : {Row{{1, 0, 10, 1}, {1, 10, 4, 2}, 0, true}, Row{{1, 0, 10, 1}, {1, 11, 10, 3}, 1, true},
                         Row{{1, 5, 10, 1}, {1, 1234, 10, 9}, 1219, true}, Row{{1, 990, 10, 100}, {2, 0, 10, 101}, 0, true},
                         Row{{1, 990, 10, 100}, {2, 40, 10, 108}, 40, false}}) {
    const ScanGap gap = gap_between(row.first, row.second);
    EXPECT_EQ(gap.scans, row.scans);
    EXPECT_EQ(gap.is_exact, row.is_exact) << "of a segment whose end was not seen the least number is known";
    EXPECT_TRUE(gap.is_consistent);
  }
}

TEST(LossTracker, OverlapOrRepeatOrOlderSegment_IsInconsistent) {
  EXPECT_FALSE(gap_between({1, 0, 10, 1}, {1, 9, 10, 2}).is_consistent);
  EXPECT_FALSE(gap_between({1, 0, 10, 1}, {1, 10, 10, 1}).is_consistent);
  EXPECT_FALSE(gap_between({2, 0, 10, 1}, {1, 10, 10, 2}).is_consistent);
}

TEST(LossTracker, AfterReset_StartsAnew) {
  LossTracker tracker;
  tracker.advance({1, 0, 10, 1});

  tracker.reset();

  EXPECT_EQ(tracker.advance({1, 500, 10, 1}).scans, 0U);
}

}  // namespace
}  // namespace dts::client
