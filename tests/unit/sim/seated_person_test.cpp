// SPDX-License-Identifier: Apache-2.0
#include "sim/seated_person.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

namespace dts::sim {
namespace {

constexpr double kTickS = 0.01;

SeatedPersonOptions somebody(ReachMode mode, std::uint64_t seed = 3) {
  SeatedPersonOptions options{.person = {.weight_kg = 68.0, .height_cm = 175.0, .arm_length_cm = 67.0, .max_reach_cm = 124.0}};
  options.habits = natural_habits(options.person, true, SeatLoadModel::Cop, seed, 1.0);
  options.mode = mode;
  options.seed = seed;
  return options;
}

std::vector<ReachPlan> reaches_of(SeatedPerson& person, double until_s) {
  std::vector<ReachPlan> reaches;
  for (double t = 0.0; t < until_s; t += kTickS) {
    const SeatedState state = person.at(t);
    if (state.reach != nullptr && (reaches.empty() || reaches.back().number != state.reach->number)) reaches.push_back(*state.reach);
  }
  return reaches;
}

TEST(SeatedPerson, BeforeSittingDownAndAfterStandingUp_TheChairIsEmpty) {
  SeatedPersonOptions options = somebody(ReachMode::Never);
  options.stand_up_s = 20.0;
  SeatedPerson person(options);

  EXPECT_FALSE(person.at(0.0).is_there);
  EXPECT_EQ(person.at(2.4).load.force_n, 0.0);
  EXPECT_TRUE(std::isnan(person.at(2.5).trunk_deg));
  EXPECT_TRUE(person.at(3.0).is_there);
  EXPECT_NEAR(person.at(10.0).load.force_n, 0.7 * 68.0 * 9.8, 25.0);
  EXPECT_NEAR(person.at(10.5).trunk_deg, -5.0, 2.0);
  EXPECT_GT(person.at(20.6).trunk_deg, 20.0);
  EXPECT_FALSE(person.at(22.0).is_there);
}

TEST(SeatedPerson, ByItself_ReachesThroughAllTargets) {
  SeatedPerson person(somebody(ReachMode::Auto));

  const std::vector<ReachPlan> reaches = reaches_of(person, 60.0);

  ASSERT_GE(reaches.size(), 6U);
  const std::array conditions = {"80", "100", "120", "150", "max"};
  for (std::size_t i = 0; i < reaches.size(); ++i) {
    EXPECT_EQ(reaches[i].number, i + 1);
    EXPECT_EQ(reaches[i].condition, conditions[i % conditions.size()]);
    if (i == 0) continue;
    EXPECT_GE(reaches[i].on_s - reaches[i - 1].on_s, 6.0);
    EXPECT_LE(reaches[i].on_s - reaches[i - 1].on_s, 9.0);
  }
  EXPECT_GT(reaches[4].trunk_deg, 40.0);
}

TEST(SeatedPerson, TargetsOutOfReach_AreNotTried) {
  SeatedPersonOptions options = somebody(ReachMode::Auto);
  options.person.max_reach_cm = 0.63 * options.person.arm_length_cm;  // as S1 of thesis Table 6.1
  SeatedPerson person(options);

  for (const ReachPlan& reach : reaches_of(person, 40.0)) EXPECT_EQ(reach.condition, "max");
}

TEST(SeatedPerson, HearsACue_ReachesAfterAReactionTimeAndNoLongerByItself) {
  SeatedPerson person(somebody(ReachMode::Auto));
  (void)person.at(5.0);
  person.hear(5.0, false, 0.0);  // get ready

  EXPECT_EQ(person.at(15.0).reach, nullptr) << "waits for Go";
  person.hear(15.0, true, 100.0);
  const ReachPlan* const reach = person.at(15.05).reach;

  ASSERT_NE(reach, nullptr);
  EXPECT_GE(reach->on_s, 15.2);
  EXPECT_LE(reach->on_s, 15.35);
  EXPECT_EQ(reach->target_cm, 100.0);
  const double flexion_deg = reach->trunk_deg;
  EXPECT_NEAR(person.at(reach->hit_s).trunk_deg, flexion_deg, 0.1);
  EXPECT_EQ(person.at(60.0).reach, nullptr);
}

TEST(SeatedPerson, CueWhileReaching_FollowsTheReachUnderWay) {
  SeatedPerson person(somebody(ReachMode::Cued));
  (void)person.at(9.0);
  person.hear(9.0, true, 124.0);
  const double end_s = person.at(9.5).reach->end_s;
  person.hear(9.5, true, 80.0);

  EXPECT_EQ(person.at(9.6).reach->target_cm, 124.0);
  const ReachPlan* const next = person.at(end_s + 0.1).reach;
  ASSERT_NE(next, nullptr);
  EXPECT_EQ(next->target_cm, 80.0);
  EXPECT_GE(next->on_s, end_s + 0.2);
}

TEST(SeatedPerson, CuesThatAreNoReach_AreNotFollowed) {
  SeatedPerson never(somebody(ReachMode::Never));
  never.hear(9.0, true, 100.0);
  EXPECT_EQ(never.at(9.5).reach, nullptr);
  SeatedPerson cued(somebody(ReachMode::Cued));
  for (const double target_cm : {0.0, -5.0, std::nan(""), HUGE_VAL}) cued.hear(9.0, true, target_cm);
  EXPECT_EQ(cued.at(9.5).reach, nullptr);
}

TEST(SeatedPerson, SameStory_WhateverTheSteps) {
  SeatedPerson fine(somebody(ReachMode::Auto));
  SeatedPerson coarse(somebody(ReachMode::Auto));
  for (int i = 0; i <= 30'000; ++i) {
    const SeatedState state = fine.at(0.001 * i);
    if (i % 1000 != 0) continue;
    const SeatedState same = coarse.at(0.001 * i);
    EXPECT_EQ(state.load.force_n, same.load.force_n) << i;
    EXPECT_EQ(state.load.y_mm, same.load.y_mm) << i;
  }
}

TEST(SeatedPerson, AtAnyTime_MovesWithoutJumps) {
  for (const bool is_healthy : {true, false}) {
    SeatedPersonOptions options = somebody(ReachMode::Auto);
    options.habits = natural_habits(options.person, is_healthy, SeatLoadModel::Cop, 3, 1.0);
    options.stand_up_s = 50.0;
    SeatedPerson person(options);
    double before_mm = person.at(3.0).load.y_mm;
    double before_n = person.at(3.0).load.force_n;
    for (double t = 3.001; t < 50.0; t += 0.001) {
      const SeatLoad load = person.at(t).load;
      ASSERT_NEAR(load.force_n, before_n, 4.0) << t;
      ASSERT_NEAR(load.y_mm, before_mm, 1.0) << t;
      before_n = load.force_n;
      before_mm = load.y_mm;
    }
  }
}

TEST(SeatedPerson, SameSeed_GivesTheSameDataAsEver) {
  RecordProperty("requirement", "LAB-6");
  for (const auto& [is_healthy, force_n, y_mm, reaction_s] :
       {std::tuple{true, 469.860300324, 66.799340844, 0.263686867}, std::tuple{false, 468.348042329, 68.461622950, 0.272565116}}) {
    SeatedPersonOptions options = somebody(ReachMode::Auto);
    options.habits = natural_habits(options.person, is_healthy, SeatLoadModel::Cop, 3, 1.0);
    SeatedPerson person(options);
    double sum_n = 0.0;
    double sum_mm = 0.0;
    for (double t = 3.0; t < 60.0; t += 0.1) {
      sum_n += person.at(t).load.force_n;
      sum_mm += person.at(t).load.y_mm;
    }
    EXPECT_NEAR(sum_n / 570.0, force_n, 1e-6) << is_healthy;
    EXPECT_NEAR(sum_mm / 570.0, y_mm, 1e-6) << is_healthy;
    double sum_s = 0.0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      options.mode = ReachMode::Cued;
      options.seed = seed;
      SeatedPerson cued(options);
      cued.hear(10.0, true, 100.0);
      sum_s += cued.at(10.5).reach->on_s - 10.0;
    }
    EXPECT_NEAR(sum_s / 20.0, reaction_s, 1e-6) << is_healthy;
  }
}

TEST(SeatedPerson, Fidgets_OnlyWhenAllowed) {
  const auto spread_mm = [](bool has_fidgets) {
    SeatedPersonOptions options = somebody(ReachMode::Never);
    options.has_fidgets = has_fidgets;
    SeatedPerson person(options);
    double least = 1e9;
    double most = -1e9;
    for (double t = 6.0; t < 120.0; t += kTickS) {
      least = std::min(least, person.at(t).load.y_mm);
      most = std::max(most, person.at(t).load.y_mm);
    }
    return most - least;
  };
  EXPECT_GT(spread_mm(true), 5.0);
  EXPECT_LT(spread_mm(false), 3.0);
}

}  // namespace
}  // namespace dts::sim
