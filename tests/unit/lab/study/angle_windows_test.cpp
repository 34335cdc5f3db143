// SPDX-License-Identifier: Apache-2.0
#include "lab/study/angle_windows.h"

#include <gtest/gtest.h>

#include "lab/study/volunteers.h"

namespace dts::lab::study {
namespace {

TEST(AngleWindows, Measured_AreThoseUnderTable63) {
  const auto windows = angle_windows();
  EXPECT_DOUBLE_EQ(windows[0].measured.least_deg, 0.4);
  EXPECT_NEAR(windows[0].measured.mean_deg, 4.1, 0.05);
  EXPECT_DOUBLE_EQ(windows[0].measured.most_deg, 9.9);
  EXPECT_DOUBLE_EQ(windows[1].measured.least_deg, 20.6);
  EXPECT_NEAR(windows[1].measured.mean_deg, 29.2, 0.05);
  EXPECT_DOUBLE_EQ(windows[2].measured.most_deg, 61.4);
  EXPECT_NEAR(windows[2].measured.mean_deg, 54.3, 0.05);
}

/// Figures of reach-model section 3.
TEST(AngleWindows, Geometry_MissesAsTheSheetSays) {
  const auto windows = angle_windows();
  EXPECT_NEAR(windows[0].bias_deg, -0.4, 0.06);
  EXPECT_NEAR(windows[1].bias_deg, -3.5, 0.06);
  EXPECT_NEAR(windows[2].bias_deg, -1.1, 0.06);
  EXPECT_NEAR(windows[0].rms_deg, 3.1, 0.06);
  EXPECT_NEAR(windows[1].rms_deg, 5.4, 0.06);
  EXPECT_NEAR(windows[2].rms_deg, 6.7, 0.06);
}

TEST(Volunteers, TrunkMeasured_BelongsToThePrintedCondition) {
  for (const Volunteer& volunteer : healthy()) {
    const auto& angles_deg = *volunteer.measured_deg;
    EXPECT_LT(angles_deg[0], physics::kModerateFromDeg) << volunteer.name;
    EXPECT_GT(angles_deg[1], physics::kModerateFromDeg) << volunteer.name;
    EXPECT_LT(angles_deg[1], physics::kMaximumFromDeg) << volunteer.name;
    EXPECT_GT(angles_deg[2], physics::kMaximumFromDeg) << volunteer.name;
  }
  for (const Volunteer& volunteer : stroke()) {
    const bool is_moderate = volunteer.boundary_deg > physics::kModerateFromDeg;
    EXPECT_EQ(volunteer.boundary_class, is_moderate ? core::TrunkClass::Moderate : core::TrunkClass::Minor) << volunteer.name;
  }
}

}  // namespace
}  // namespace dts::lab::study
