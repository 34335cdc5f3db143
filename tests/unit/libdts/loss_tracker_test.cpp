// SPDX-License-Identifier: Apache-2.0
#include "../clients/libdts/loss_tracker.h"

#include <gtest/gtest.h>

namespace dts::client {
namespace {

Hole hole_between(const Position& first, const Position& second) {
  LossTracker tracker;
  EXPECT_EQ(tracker.advance(first).scans, 0U);
  return tracker.advance(second);
}

TEST(LossTracker, FirstBlockInTheMiddle_NothingIsMissing) {
  LossTracker tracker;

  const Hole hole = tracker.advance({.segment = 3, .first_scan = 1000, .scan_count = 10, .sequence = 55});

  EXPECT_EQ(hole.scans, 0U);
  EXPECT_TRUE(hole.is_exact);
}

TEST(LossTracker, AdjacentBlocks_NothingIsMissing) {
  const Hole hole = hole_between({1, 0, 10, 1}, {1, 10, 4, 2});

  EXPECT_EQ(hole.scans, 0U);
  EXPECT_TRUE(hole.is_exact && hole.is_consistent);
}

TEST(LossTracker, OneScanMissing_IsCounted) { EXPECT_EQ(hole_between({1, 0, 10, 1}, {1, 11, 10, 3}).scans, 1U); }

TEST(LossTracker, BlocksOfDifferentLengthMissing_ScansAreCountedNotBlocks) {
  EXPECT_EQ(hole_between({1, 0, 10, 1}, {1, 1234, 10, 9}).scans, 1224U);
}

TEST(LossTracker, NewSegmentWithoutHoleInTheSequence_NothingIsMissing) {
  const Hole hole = hole_between({1, 990, 10, 100}, {2, 0, 10, 101});

  EXPECT_EQ(hole.scans, 0U);
  EXPECT_TRUE(hole.is_exact);
}

TEST(LossTracker, NewSegmentAfterMissingBlocks_LeastNumberAndNotExact) {
  const Hole hole = hole_between({1, 990, 10, 100}, {2, 40, 10, 108});

  EXPECT_EQ(hole.scans, 40U);
  EXPECT_FALSE(hole.is_exact);
  EXPECT_TRUE(hole.is_consistent);
}

TEST(LossTracker, OverlapOrRepeatOrOlderSegment_IsInconsistent) {
  EXPECT_FALSE(hole_between({1, 0, 10, 1}, {1, 9, 10, 2}).is_consistent);
  EXPECT_FALSE(hole_between({1, 0, 10, 1}, {1, 10, 10, 1}).is_consistent);
  EXPECT_FALSE(hole_between({2, 0, 10, 1}, {1, 10, 10, 2}).is_consistent);
}

TEST(LossTracker, AfterReset_StartsAnew) {
  LossTracker tracker;
  tracker.advance({1, 0, 10, 1});

  tracker.reset();

  EXPECT_EQ(tracker.advance({1, 500, 10, 1}).scans, 0U);
}

}  // namespace
}  // namespace dts::client
