// SPDX-License-Identifier: Apache-2.0
#include "lab/study/study_reaches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lab/study/experiments.h"

namespace dts::lab::study {
namespace {

void ignore(double) {}

std::vector<double> swings(const StudyGroup& group, const std::string& condition) {
  std::vector<double> all;
  for (const StudyReach& one : group.reaches) {
    if (one.condition == condition) all.push_back(one.reach ? one.reach->features.d2_mm() : std::nan(""));
  }
  return all;
}

TEST(StudyReaches, SameSeed_GivesTheSamePeopleWhateverElseTheyReachTo) {
  const auto beyond = natural_reaches(teachers().first(1), Targets::BeyondReach, 7, ignore);
  const auto all = natural_reaches(teachers().first(1), Targets::All, 7, ignore);
  const auto others = natural_reaches(teachers().first(1), Targets::BeyondReach, 8, ignore);
  ASSERT_TRUE(beyond && all && others);
  EXPECT_EQ(beyond->reaches.size(), 45U);
  EXPECT_EQ(all->reaches.size(), 75U);
  EXPECT_EQ(swings(*beyond, "150"), swings(*all, "150"));
  EXPECT_NE(swings(*beyond, "150"), swings(*others, "150"));
}

TEST(StudyReaches, FirstOfAnotherGroup_IsSomebodyElse) {
  Volunteer twin = teachers().front();
  twin.measured_deg = {4.0, 25.0, 55.0};  // as the healthy of table 6.3
  const auto one = natural_reaches(teachers().first(1), Targets::BeyondReach, 1, ignore);
  const auto other = natural_reaches(std::span(&twin, 1), Targets::BeyondReach, 1, ignore);
  ASSERT_TRUE(one && other);
  EXPECT_NE(swings(*one, "150"), swings(*other, "150"));
}

TEST(StudyReaches, AfterAStroke_TheTrunkBendsAsTheThesisMeasured) {
  const auto group = boundary_reaches(stroke(), 1, ignore);
  ASSERT_TRUE(group) << group.error().what;
  ASSERT_EQ(group->reaches.size(), 75U);
  for (std::size_t k = 0; k < stroke().size(); ++k) {
    double sum_deg = 0.0;
    for (const StudyReach& one : group->reaches) sum_deg += one.volunteer == k ? one.flexion_deg : 0.0;
    EXPECT_NEAR(sum_deg / 15.0, *stroke()[k].boundary_deg, 3.0) << stroke()[k].name;
  }
  EXPECT_TRUE(
      std::ranges::all_of(group->reaches, [](const StudyReach& one) { return one.wanted == stroke()[one.volunteer].boundary_class; }));
}

TEST(StudyReaches, IdealReaches_AreFoundAndRepeatThemselves) {
  const auto group = ideal_reaches(teachers(), kPaces, 2);
  ASSERT_TRUE(group) << group.error().what;
  ASSERT_EQ(group->reaches.size(), 72U);  // 3 people, 3 targets, 4 paces, twice
  for (const StudyReach& one : group->reaches) ASSERT_TRUE(one.reach.has_value()) << one.volunteer << ' ' << one.condition;
  for (std::size_t k = 0; k < group->reaches.size(); k += 8) {
    EXPECT_NEAR(group->reaches[k].reach->features.d2_mm(), group->reaches[k + 4].reach->features.d2_mm(), 1e-3);
  }
}

TEST(StudyReaches, TrainingSet_KeepsGroupsApartAndLeavesOutWhatWasNotFound) {
  StudyGroup first{.volunteers = {teachers()[0]}, .reaches = {{.volunteer = 0, .wanted = core::TrunkClass::Minor}}};
  StudyGroup second{.volunteers = {healthy()[0]}, .reaches = {{.volunteer = 0, .wanted = core::TrunkClass::Maximum}}};
  second.reaches[0].reach = core::ReachEvent{};
  const auto set = training_set({&first, &second});
  ASSERT_EQ(set.subjects.size(), 2U);
  ASSERT_EQ(set.reaches.size(), 1U);
  EXPECT_EQ(set.reaches[0].subject, 1U);
  EXPECT_NEAR(set.subjects[0].max_flexion_deg, 54.9, 0.1);  // reach-model section 3
}

}  // namespace
}  // namespace dts::lab::study
