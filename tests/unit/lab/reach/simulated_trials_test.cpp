// SPDX-License-Identifier: Apache-2.0
#include "lab/reach/simulated_trials.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dts::lab::reach {
namespace {

const reach::Subject kA{.name = "A", .person = {.weight_kg = 68.0, .height_cm = 175.0, .arm_length_cm = 67.0, .max_reach_cm = 124.0}};
const reach::Subject kB{.name = "B", .person = {.weight_kg = 52.0, .height_cm = 165.0, .arm_length_cm = 59.0, .max_reach_cm = 115.0}};

SimulatedTrials simulated(const TrialPlan& plan, const std::vector<reach::Subject>& subjects = {kA, kB}) {
  auto trials = simulate_trials(subjects, plan, [](double) {});
  EXPECT_TRUE(trials.has_value()) << (trials ? "" : core::to_string(trials.error()));
  return std::move(*trials);
}

double transient_mm(const physics::RigModel& rig, const std::array<double, 4>& volts) {
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) sum += (rig.sensors[k].unloaded_gap - rig.sensors[k].curve.gap(core::Volts{volts[k]})).value;
  return sum / 4.0;
}

TEST(SimulatedTrials, Ideal_AreTheModelsReaches) {
  const SimulatedTrials trials = simulated({.conditions = {"max"}, .trials_per_condition = 1, .is_ideal = true}, {kA});

  ASSERT_EQ(trials.set.trials.size(), 1U);
  EXPECT_NEAR(trials.trunk_deg[0], 54.9, 0.05);
  const auto& volts = trials.set.trials[0].volts;
  EXPECT_EQ(volts.size(), 420U) << "1.5 s of rest, two phases of 0.75 s, 1.2 s of rest";
  double least_mm = 1e9;
  double most_mm = 0.0;
  for (const auto& scan : volts) {
    least_mm = std::min(least_mm, transient_mm(trials.set.rig, scan));
    most_mm = std::max(most_mm, transient_mm(trials.set.rig, scan));
  }
  EXPECT_NEAR(transient_mm(trials.set.rig, volts[0]), 3.49, 0.05);
  EXPECT_GT(most_mm, 5.8);
  EXPECT_LT(least_mm, 2.7);
}

TEST(SimulatedTrials, Plan_IsCarriedOutBySubjectAndCondition) {
  const SimulatedTrials trials = simulated({.conditions = {"80", "150"}, .trials_per_condition = 3});

  ASSERT_EQ(trials.set.trials.size(), 12U);
  ASSERT_EQ(trials.trunk_deg.size(), 12U);
  EXPECT_EQ(trials.set.trials[0].condition, "80");
  EXPECT_EQ(trials.set.trials[3].condition, "150");
  EXPECT_EQ(trials.set.trials[6].subject, 1U);
  EXPECT_EQ(trials.set.trials[6].number, 1U);
  for (std::size_t i = 0; i < 12; ++i) {
    if (trials.set.trials[i].condition == "80") {
      EXPECT_EQ(trials.trunk_deg[i], 0.0);
    } else {
      EXPECT_NEAR(trials.trunk_deg[i], 25.0, 15.0);
    }
  }
}

TEST(SimulatedTrials, Paces_AreCycled) {
  const SimulatedTrials trials =
      simulated({.conditions = {"max"}, .trials_per_condition = 3, .paces_s = {0.75, 1.5}, .is_ideal = true}, {kA});

  const auto& set = trials.set.trials;
  EXPECT_EQ(set[1].volts.size() - set[0].volts.size(), 150U);
  EXPECT_EQ(set[2].volts.size(), set[0].volts.size());
}

TEST(SimulatedTrials, SameSeed_SameTrialsAndPeopleDifferAsMuchAsAsked) {
  const auto angles = [](std::uint64_t seed, double between_people) {
    return simulated({.conditions = {"max"}, .trials_per_condition = 4, .between_people = between_people, .seed = seed, .has_volts = false})
        .trunk_deg;
  };
  EXPECT_EQ(angles(1, 1.0), angles(1, 1.0));
  EXPECT_NE(angles(1, 1.0), angles(2, 1.0));

  const auto deviation = [&](double between_people) {
    double sum = 0.0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      const std::vector<double> of = angles(seed, between_people);
      sum += std::pow(std::accumulate(of.begin(), of.begin() + 4, 0.0) / 4.0 - 54.9, 2.0);
    }
    return std::sqrt(sum / 12.0);
  };
  EXPECT_GT(deviation(1.0), 1.5 * deviation(0.0));
}

TEST(SimulatedTrials, TargetBeyondTheMaximumReach_IsLeftOut) {
  reach::Subject s5{
      .name = "S5", .is_healthy = false, .person = {.weight_kg = 83.0, .height_cm = 175.0, .arm_length_cm = 69.0, .max_reach_cm = 98.0}};
  const SimulatedTrials trials = simulated({.conditions = {"120", "150", "max"}, .trials_per_condition = 2}, {s5});

  EXPECT_EQ(trials.set.trials.size(), 4U);
  EXPECT_TRUE(std::ranges::none_of(trials.set.trials, [](const reach::Trial& trial) { return trial.condition == "150"; }));
}

TEST(SimulatedTrials, TurnOfTheTrunk_IsTheSameInAllTrialsWhateverTheTarget) {
  TrialPlan plan{.conditions = {"80", "max"}, .trials_per_condition = 3, .trunk_turn_deg = 12.0, .has_volts = false};
  const std::vector<double> turned = simulated(plan, {kA}).trunk_deg;
  plan.trunk_turn_deg = 2.0;
  const std::vector<double> little = simulated(plan, {kA}).trunk_deg;

  ASSERT_EQ(turned.size(), 6U);
  for (std::size_t k = 0; k < turned.size(); ++k) {
    EXPECT_DOUBLE_EQ(turned[k], turned[0]);
    EXPECT_NEAR(turned[k] - little[k], 10.0, 1e-9);  // from the person's own lean
    EXPECT_LT(little[k], 0.0);                       // still behind upright
  }
}

TEST(SimulatedTrials, MoreNoise_OtherVoltsOfTheSameReach) {
  TrialPlan plan{.conditions = {"120"}, .trials_per_condition = 1};
  const auto usual = simulated(plan);
  plan.noise_v = 0.0;
  const auto quiet = simulated(plan);

  ASSERT_EQ(usual.set.trials[0].volts.size(), quiet.set.trials[0].volts.size());
  EXPECT_NE(usual.set.trials[0].volts, quiet.set.trials[0].volts);
  EXPECT_EQ(usual.trunk_deg, quiet.trunk_deg);
}

TEST(SimulatedTrials, NonsensePlan_Refused) {
  const auto refused = [](const TrialPlan& plan) { return !simulate_trials({kA}, plan, [](double) {}).has_value(); };
  EXPECT_TRUE(refused({.conditions = {"far"}}));
  EXPECT_TRUE(refused({.trials_per_condition = 0}));
  EXPECT_TRUE(refused({.paces_s = {0.0}}));
  EXPECT_TRUE(refused({.between_people = 2.5}));
  EXPECT_TRUE(refused({.between_people = std::nan("")}));
  EXPECT_TRUE(refused({.rate_hz = 1.0}));
  EXPECT_TRUE(refused({.noise_v = -1.0}));
  EXPECT_TRUE(refused({.trunk_turn_deg = 61.0}));
  reach::Subject nobody{.name = "nobody", .person = {.height_cm = 0.0}};
  EXPECT_FALSE(simulate_trials({nobody}, {}, [](double) {}).has_value());
}

// Every stage of the daemon sees what it would see of a person: all reaches with the trunk are found where they are.
TEST(SimulatedTrials, ThroughTheDaemonsStages_ReachesAreFound) {
  const SimulatedTrials trials = simulated({.conditions = {"150", "max"}, .trials_per_condition = 10});

  const auto reaches = reach::find_reaches(trials.set, [](double) {});

  ASSERT_EQ(reaches.size(), trials.set.trials.size());
  std::size_t found = 0;
  for (const auto& event : reaches) found += event && event->features.d2_mm() > 0.3 ? 1 : 0;
  EXPECT_GE(found, reaches.size() - 1);
}

}  // namespace
}  // namespace dts::lab::reach
