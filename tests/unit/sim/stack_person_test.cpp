// SPDX-License-Identifier: Apache-2.0
#include "sim/stack_person.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dts::sim {
namespace {

TEST(StackPerson, Shear_IsMassTimesAccelerationOnceTheStanceIsReached) {
  physics::Stance stance{.load = {981.0}, .step_on_s = 1.0, .seed = 4};
  auto person = StackPerson::create(stance, physics::Plate{});
  ASSERT_TRUE(person.has_value());
  Sway sway(4);

  EXPECT_EQ(person->at(0.9).ml_n, 0.0);
  EXPECT_EQ(person->at(1.0 + StandingPerson::kLoadingS).ap_n, 0.0);  // the sway has not begun
  for (double time_s = 5.0; time_s < 20.0; time_s += 0.5) {
    const StandingMoment moment = person->at(time_s);
    const SwayMotion motion = sway.motion_at(time_s);
    EXPECT_NEAR(moment.ml_n, 100.0 * motion.ml_m_per_s2, 1e-9);
    EXPECT_NEAR(moment.ap_n, 100.0 * motion.ap_m_per_s2, 1e-9);
    EXPECT_NEAR(moment.contact.cop.ml_mm, motion.cop.ml_mm, 1e-9);
  }
}

TEST(StackPerson, Weight_IsRefusedBecauseItDoesNotSway) {
  const auto refused = StackPerson::create({.kind = physics::ContactKind::Point}, physics::Plate{});
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().what, "stance: a weight at one point does not sway");
}

}  // namespace
}  // namespace dts::sim
