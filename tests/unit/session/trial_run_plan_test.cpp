// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "session/trial_run.h"

namespace dts::session {
namespace {

TrialPlan plan_of(std::size_t conditions, std::uint32_t trials_per_block, std::uint32_t blocks, TrialOrder order) {
  TrialPlan plan{.trials_per_block = trials_per_block, .blocks = blocks, .order = order};
  for (std::size_t index = 0; index < conditions; ++index) plan.conditions.push_back({.name = std::to_string(index)});
  return plan;
}

std::vector<std::size_t> conditions_of(const std::vector<PlannedTrial>& places) {
  std::vector<std::size_t> order;
  for (const PlannedTrial& place : places) order.push_back(place.condition);
  return order;
}

/// Most often minus least often, over all conditions.
template <class Places>
std::size_t imbalance(const Places& places, std::size_t conditions) {
  std::vector<std::size_t> count(conditions, 0);
  for (const PlannedTrial& place : places) ++count.at(place.condition);
  return *std::ranges::max_element(count) - *std::ranges::min_element(count);
}

std::map<std::uint32_t, std::vector<PlannedTrial>> by_block(const std::vector<PlannedTrial>& places) {
  std::map<std::uint32_t, std::vector<PlannedTrial>> blocks;
  for (const PlannedTrial& place : places) blocks[place.block].push_back(place);
  return blocks;
}

TEST(MakePlan, AsListed_TakesTheConditionsInTurnOverAllBlocks) {
  const auto places = make_plan(plan_of(3, 2, 3, TrialOrder::AsListed), 7);
  EXPECT_THAT(conditions_of(places), testing::ElementsAre(0, 1, 2, 0, 1, 2));
  EXPECT_EQ(places[1].block, 1U);
  EXPECT_EQ(places[2].block, 2U);
  EXPECT_EQ(places[5].trial, 6U);
}

TEST(MakePlan, AnyShape_IsBalancedInEachBlockAndOverAll) {
  RecordProperty("requirement", "SES-1");
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    for (std::size_t conditions = 1; conditions <= 6; ++conditions) {
      for (const std::uint32_t trials_per_block : {1U, 2U, 4U, 5U, 7U, 15U}) {
        const auto places = make_plan(plan_of(conditions, trials_per_block, 5, TrialOrder::Randomised), seed);
        ASSERT_EQ(places.size(), std::size_t{trials_per_block} * 5);
        ASSERT_LE(imbalance(places, conditions), 1U) << seed << ' ' << conditions << ' ' << trials_per_block;
        const auto blocks = by_block(places);
        ASSERT_EQ(blocks.size(), 5U);
        for (const auto& [block, trials] : blocks) {
          ASSERT_EQ(trials.size(), trials_per_block);
          ASSERT_LE(imbalance(trials, conditions), 1U) << seed << ' ' << conditions << ' ' << trials_per_block << ' ' << block;
        }
      }
    }
  }
}

TEST(MakePlan, SameSeed_GivesTheSamePlan) {
  const auto plan = plan_of(5, 15, 5, TrialOrder::Randomised);
  EXPECT_EQ(make_plan(plan, 42), make_plan(plan, 42));
  EXPECT_NE(conditions_of(make_plan(plan, 42)), conditions_of(make_plan(plan, 43)));
}

TEST(MakePlan, KnownSeed_GivesTheOrderThatRecordingsWereMadeWith) {
  auto plan = plan_of(5, 15, 1, TrialOrder::Randomised);
  plan.cue_delay_min_s = 1.5;
  plan.cue_delay_max_s = 3.5;
  const auto places = make_plan(plan, 20261121);  // expected values: computed apart, from the published generator
  EXPECT_THAT(conditions_of(places), testing::ElementsAre(1, 0, 1, 2, 0, 2, 3, 4, 4, 2, 3, 4, 3, 0, 1));
  EXPECT_EQ(places[0].cue_delay_s, 2.7);
  EXPECT_EQ(places[14].cue_delay_s, 3.149);
}

TEST(MakePlan, ManySeeds_PutEveryConditionFirstAboutAsOften) {
  std::map<std::size_t, int> first;
  std::map<std::size_t, int> extra;  // 7 trials, 5 conditions: two come once more
  for (std::uint64_t seed = 0; seed < 5000; ++seed) {
    const auto places = make_plan(plan_of(5, 7, 1, TrialOrder::Randomised), seed);
    ++first[places[0].condition];
    for (std::size_t condition = 0; condition < 5; ++condition) {
      if (std::ranges::count(conditions_of(places), condition) == 2) ++extra[condition];
    }
  }
  for (std::size_t condition = 0; condition < 5; ++condition) {  // 1000 and 2000 expected, standard deviations 28 and 35
    EXPECT_NEAR(first[condition], 1000, 150) << condition;
    EXPECT_NEAR(extra[condition], 2000, 180) << condition;
  }
}

TEST(MakePlan, CueDelays_LieBetweenTheTwoInWholeMillisecondsAndReachBothEnds) {
  auto plan = plan_of(2, 200, 50, TrialOrder::Randomised);
  plan.cue_delay_min_s = 1.5;
  plan.cue_delay_max_s = 1.52;
  std::set<double> seen;
  for (const PlannedTrial& place : make_plan(plan, 1)) seen.insert(place.cue_delay_s);
  EXPECT_EQ(seen.size(), 21U);
  EXPECT_EQ(*seen.begin(), 1.5);
  EXPECT_EQ(*seen.rbegin(), 1.52);
}

TEST(MakePlan, NothingToPlan_IsEmpty) {
  EXPECT_TRUE(make_plan({}, 1).empty());
  EXPECT_TRUE(make_plan(plan_of(3, 0, 5, TrialOrder::Randomised), 1).empty());
  EXPECT_TRUE(make_plan(plan_of(3, 5, 0, TrialOrder::AsListed), 1).empty());
}

TEST(MakePlan, AbsurdNumbers_AreCutOff) {
  constexpr auto kHuge = std::numeric_limits<std::uint32_t>::max();
  auto plan = plan_of(3, kHuge, kHuge, TrialOrder::Randomised);
  plan.cue_delay_min_s = std::nan("");
  plan.cue_delay_max_s = std::numeric_limits<double>::infinity();
  EXPECT_EQ(make_plan(plan, 1).size(), kMostTrials);
}

}  // namespace
}  // namespace dts::session
