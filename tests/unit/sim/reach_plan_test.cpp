// SPDX-License-Identifier: Apache-2.0
#include "sim/reach_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "unit/physics/body/volunteer_a.h"

namespace dts::sim {
namespace {

using physics::test::kVolunteerA;
constexpr double kWithinReachCm = 0.8 * 67.0;

ReachPlan planned(const SittingHabits& habits, double target_cm, std::uint32_t number = 1, bool is_double = false) {
  return plan_reach(kVolunteerA, habits, {.number = number, .start_s = 2.0, .target_cm = target_cm, .is_double = is_double},
                    CounterRandom(7));
}

SittingHabits natural(bool is_healthy, double between_people = 1.0) {
  return natural_habits(kVolunteerA, is_healthy, SeatLoadModel::Cop, 5, between_people);
}

TEST(ReachPlan, Ideal_IsTheThesissMovement) {
  const ReachPlan plan = planned(ideal_habits(kVolunteerA, SeatLoadModel::Cop, 0.75), kVolunteerA.max_reach_cm);

  EXPECT_NEAR(plan.trunk_deg, physics::trunk_flexion_deg(kVolunteerA, kVolunteerA.max_reach_cm), 1e-12);
  EXPECT_DOUBLE_EQ(plan.hit_s, 2.75);
  EXPECT_DOUBLE_EQ(plan.back_s, 2.75);
  EXPECT_DOUBLE_EQ(plan.end_s, 3.5);
  for (double t = 0.0; t < 2.0; t += 0.01) {
    EXPECT_NEAR(plan.progress(2.0 + t).position, there_and_back(t, 0.75).position, 1e-12);
    EXPECT_NEAR(plan.progress(2.0 + t).acceleration, there_and_back(t, 0.75).acceleration, 1e-9);
  }
}

// Rates and accelerations go into the dynamics: they must be those of the positions.
TEST(ReachPlan, OfAnybody_RatesAreDerivativesAndTheWayLeadsBack) {
  for (std::uint32_t number = 1; number <= 40; ++number) {
    SCOPED_TRACE(number);
    const ReachPlan plan = planned(natural(number % 2 == 0), kVolunteerA.max_reach_cm, number, number % 5 == 0);
    ASSERT_LE(plan.move_count, ReachPlan::kMostMoves);
    EXPECT_LT(plan.on_s, plan.hit_s);
    EXPECT_LT(plan.hit_s, plan.back_s);
    EXPECT_LT(plan.back_s, plan.end_s);
    EXPECT_NEAR(plan.progress(plan.hit_s).position, 1.0, 1e-9);
    EXPECT_NEAR(plan.progress(plan.end_s + 1.0).position, 0.0, 1e-9);
    for (double t = plan.on_s + 0.05; t < plan.end_s; t += 0.05) {
      constexpr double kStepS = 1e-5;
      const Travel before = plan.progress(t - kStepS);
      const Travel after = plan.progress(t + kStepS);
      EXPECT_NEAR(plan.progress(t).rate, (after.position - before.position) / (2.0 * kStepS), 1e-5);
      EXPECT_NEAR(plan.progress(t).acceleration, (after.rate - before.rate) / (2.0 * kStepS), 0.02);
    }
  }
}

TEST(ReachPlan, WithinTheArmsReach_HealthyUseTheArmAloneOthersTheTrunk) {
  for (std::uint32_t number = 1; number <= 20; ++number) {
    const ReachPlan healthy = planned(natural(true), kWithinReachCm, number);
    EXPECT_FALSE(healthy.moves_trunk);
    EXPECT_EQ(healthy.trunk_deg, 0.0);
    EXPECT_EQ(healthy.lift(healthy.hit_s, 1.5), 0.0);
    SittingHabits stroke = natural(false, 0.0);
    stroke.arm_use = 0.6;
    EXPECT_GT(planned(stroke, kWithinReachCm, number).trunk_deg, 2.0);
  }
}

TEST(ReachPlan, AfterAStroke_SlowerAndWithCorrections) {
  double healthy_s = 0.0;
  double stroke_s = 0.0;
  std::size_t healthy_moves = 0;
  std::size_t stroke_moves = 0;
  for (std::uint32_t number = 1; number <= 30; ++number) {
    const ReachPlan healthy = planned(natural(true, 0.0), kVolunteerA.max_reach_cm, number);
    const ReachPlan stroke = planned(natural(false, 0.0), kVolunteerA.max_reach_cm, number);
    healthy_s += healthy.end_s - healthy.on_s;
    stroke_s += stroke.end_s - stroke.on_s;
    healthy_moves += healthy.move_count;
    stroke_moves += stroke.move_count;
  }
  EXPECT_GT(stroke_s, 1.4 * healthy_s);
  EXPECT_GT(stroke_moves, 2 * healthy_moves);
}

TEST(ReachPlan, Double_GoesOutTwice) {
  const ReachPlan plan = planned(ideal_habits(kVolunteerA, SeatLoadModel::Cop, 0.75), kVolunteerA.max_reach_cm, 1, true);
  int maxima = 0;
  for (double t = plan.on_s; t < plan.end_s; t += 0.01) {
    maxima += plan.progress(t).rate > 0.0 && plan.progress(t + 0.01).rate <= 0.0 ? 1 : 0;
  }
  EXPECT_EQ(maxima, 2);
  EXPECT_NEAR(plan.progress(plan.back_s).position, 1.0, 1e-9);
}

TEST(ReachPlan, SameSeedAndNumber_SameReach) {
  EXPECT_EQ(planned(natural(true), 100.0, 3).end_s, planned(natural(true), 100.0, 3).end_s);
  EXPECT_NE(planned(natural(true), 100.0, 3).end_s, planned(natural(true), 100.0, 4).end_s);
}

TEST(SittingHabits, WithoutSpread_AreTheSameForEverySeed) {
  const auto of = [](std::uint64_t seed, double spread) { return natural_habits(kVolunteerA, true, SeatLoadModel::Cop, seed, spread); };
  EXPECT_EQ(of(1, 0.0).load.rest_y_mm, of(2, 0.0).load.rest_y_mm);
  EXPECT_EQ(of(1, 0.0).flexion_factor, 1.0);
  EXPECT_EQ(of(1, 0.0).rest_y_deviation_mm, 1.0) << "nobody sits down in the same place twice";
  EXPECT_EQ(ideal_habits(kVolunteerA, SeatLoadModel::Cop, 0.75).rest_y_deviation_mm, 0.0);
  EXPECT_NE(of(1, 1.0).load.rest_y_mm, of(2, 1.0).load.rest_y_mm);
  EXPECT_EQ(of(1, 1.0).load.rest_y_mm, of(1, 1.0).load.rest_y_mm);
}

TEST(SittingHabits, AfterAStroke_ReachWithPartOfTheArm) {
  physics::Person near = kVolunteerA;
  near.max_reach_cm = 0.6 * near.arm_length_cm;  // takes no flexion, however little of the arm is used
  double sum = 0.0;
  double least = 1.0;
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const double arm_use = natural_habits(near, false, SeatLoadModel::Cop, seed, 1.0).arm_use;
    sum += arm_use;
    least = std::min(least, arm_use);
    EXPECT_LE(arm_use, 1.0);
    EXPECT_EQ(natural_habits(near, true, SeatLoadModel::Cop, seed, 1.0).arm_use, 1.0);
    const double far = natural_habits(kVolunteerA, false, SeatLoadModel::Cop, seed, 1.0).arm_use;
    physics::Person shortened = kVolunteerA;
    shortened.arm_length_cm *= far;
    EXPECT_TRUE(far == 1.0 || physics::trunk_flexion_deg(shortened, shortened.max_reach_cm) <= 60.0) << "as far as a healthy person bends";
  }
  EXPECT_NEAR(sum / 500.0, 0.74, 4.0 * 0.10 / std::sqrt(500.0));  // four standard errors
  EXPECT_GE(least, 0.5);
  EXPECT_LT(least, 0.55);
}

}  // namespace
}  // namespace dts::sim
