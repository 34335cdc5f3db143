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

TEST(Placement, Things_FollowInOrderAndEndUnlessRepeated) {
  PlacementTimes repeated = kTimes;
  repeated.repeats = true;
  for (std::size_t thing = 0; thing < 5; ++thing) {
    const double time_s = 10.0 + 4.0 * static_cast<double>(thing) + 1.0;
    EXPECT_EQ(placement_at(kTimes, 3, time_s).part, thing < 3 ? 1.0 : 0.0);
    EXPECT_TRUE(thing >= 3 || placement_at(kTimes, 3, time_s).index == thing);
    EXPECT_EQ(placement_at(repeated, 3, time_s).part, 1.0);
    EXPECT_EQ(placement_at(repeated, 3, time_s).index, thing % 3);
  }
}

TEST(Placement, WithoutPauseOrRamp_TouchesZeroBetweenTwoOrSteps) {
  const PlacementTimes no_pause{.first_s = 0.0, .ramp_s = 0.5, .hold_s = 1.0, .pause_s = 0.0};
  EXPECT_EQ(placement_at(no_pause, 2, 2.0).part, 0.0);
  EXPECT_EQ(placement_at(no_pause, 2, 2.0).index, 1U);
  EXPECT_EQ(placement_at(no_pause, 2, 2.25).part, 0.5);

  const PlacementTimes no_ramp{.first_s = 0.0, .ramp_s = 0.0, .hold_s = 1.0, .pause_s = 1.0};
  EXPECT_EQ(placement_at(no_ramp, 1, 0.0).part, 1.0);
  EXPECT_EQ(placement_at(no_ramp, 1, 0.999).part, 1.0);
  EXPECT_EQ(placement_at(no_ramp, 1, 1.001).part, 0.0);
}

}  // namespace
}  // namespace dts::device::sim
