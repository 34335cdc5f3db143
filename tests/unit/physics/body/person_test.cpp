// SPDX-License-Identifier: Apache-2.0
#include "physics/body/person.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "unit/physics/body/volunteer_a.h"

namespace dts::physics {
namespace {

using test::kVolunteerA;
constexpr Person kB{.weight_kg = 52.0, .height_cm = 165.0, .arm_length_cm = 59.0, .max_reach_cm = 115.0};
constexpr Person kC{.weight_kg = 81.0, .height_cm = 182.0, .arm_length_cm = 71.0, .max_reach_cm = 130.0};

void expect_angles(const Person& person, double at_120_deg, double at_150_deg, double at_max_deg) {
  EXPECT_NEAR(trunk_flexion_deg(person, 1.2 * person.arm_length_cm), at_120_deg, 0.05);
  EXPECT_NEAR(trunk_flexion_deg(person, 1.5 * person.arm_length_cm), at_150_deg, 0.05);
  EXPECT_NEAR(trunk_flexion_deg(person, person.max_reach_cm), at_max_deg, 0.05);
}

TEST(TrunkFlexion, OfTheThesisVolunteers_AsTheSheet) {
  expect_angles(kVolunteerA, 3.6, 25.2, 54.9);
  expect_angles(kB, 3.4, 23.5, 59.6);
  expect_angles(kC, 3.7, 25.7, 54.4);
}

TEST(TrunkFlexion, WithinReachOfTheFingertip_IsNone) {
  EXPECT_EQ(trunk_flexion_deg(kVolunteerA, 0.8 * kVolunteerA.arm_length_cm), 0.0);
  EXPECT_EQ(trunk_flexion_deg(kVolunteerA, 1.15 * kVolunteerA.arm_length_cm), 0.0);
  EXPECT_GT(trunk_flexion_deg(kVolunteerA, 1.151 * kVolunteerA.arm_length_cm), 0.0);
}

TEST(TrunkFlexion, WithDistance_NeverFallsAndHasALimit) {
  double before_deg = 0.0;
  for (double target_cm = 10.0; target_cm < 400.0; target_cm += 0.5) {
    const double flexion_deg = trunk_flexion_deg(kVolunteerA, target_cm);
    EXPECT_GE(flexion_deg, before_deg);
    before_deg = flexion_deg;
  }
  EXPECT_NEAR(before_deg, std::asin(0.97) * 180.0 / std::acos(-1.0), 1e-9);
}

TEST(TrunkFlexion, OfNoMeasure_IsUnknown) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(trunk_flexion_deg({.height_cm = 0.0}, 100.0)));
  EXPECT_TRUE(std::isnan(trunk_flexion_deg({.arm_length_cm = -1.0}, 100.0)));
  EXPECT_TRUE(std::isnan(trunk_flexion_deg({.height_cm = std::numeric_limits<double>::infinity()}, 100.0)));
  EXPECT_TRUE(std::isnan(trunk_flexion_deg({}, kNan)));
}

}  // namespace
}  // namespace dts::physics
