// SPDX-License-Identifier: Apache-2.0
#include "device/sim/placement.h"

#include <gtest/gtest.h>

namespace dts::device::sim {
namespace {

constexpr PlacementTimes kTimes{.first_s = 10.0, .ramp_s = 0.5, .hold_s = 2.0, .pause_s = 1.0};  // 4 s each

TEST(Placement, Phases_AreRampHoldRampPause) {
  EXPECT_EQ(placement_at(kTimes, 3, 9.999).part, 0.0);
  EXPECT_EQ(placement_at(kTimes, 3, 10.25).part, 0.5);
  EXPECT_EQ(placement_at(kTimes, 3, 10.5).part, 1.0);
  EXPECT_EQ(placement_at(kTimes, 3, 12.5).part, 1.0);
  EXPECT_EQ(placement_at(kTimes, 3, 12.75).part, 0.5);
  EXPECT_EQ(placement_at(kTimes, 3, 13.0).part, 0.0);
  EXPECT_EQ(placement_at(kTimes, 3, 13.999).part, 0.0);
}

TEST(Placement, Things_FollowInOrderAndEnd) {
  for (std::size_t thing = 0; thing < 3; ++thing) {
    const Placement now = placement_at(kTimes, 3, 10.0 + 4.0 * static_cast<double>(thing) + 1.0);
    EXPECT_EQ(now.index, thing);
    EXPECT_EQ(now.part, 1.0);
  }
  EXPECT_EQ(placement_at(kTimes, 3, 10.0 + 12.0 + 1.0).part, 0.0);
}

TEST(Placement, Repeated_BeginsAgainWithTheFirst) {
  PlacementTimes times = kTimes;
  times.repeats = true;

  const Placement now = placement_at(times, 3, 10.0 + 4.0 * 4.0 + 1.0);

  EXPECT_EQ(now.index, 1U);
  EXPECT_EQ(now.part, 1.0);
}

TEST(Placement, WithoutPause_TouchesZeroBetweenTwo) {
  const PlacementTimes times{.first_s = 0.0, .ramp_s = 0.5, .hold_s = 1.0, .pause_s = 0.0};

  EXPECT_EQ(placement_at(times, 2, 2.0).part, 0.0);
  EXPECT_EQ(placement_at(times, 2, 2.0).index, 1U);
  EXPECT_EQ(placement_at(times, 2, 2.25).part, 0.5);
}

TEST(Placement, WithoutRamp_Steps) {
  const PlacementTimes times{.first_s = 0.0, .ramp_s = 0.0, .hold_s = 1.0, .pause_s = 1.0};

  EXPECT_EQ(placement_at(times, 1, 0.0).part, 1.0);
  EXPECT_EQ(placement_at(times, 1, 0.999).part, 1.0);
  EXPECT_EQ(placement_at(times, 1, 1.001).part, 0.0);
}

}  // namespace
}  // namespace dts::device::sim
