// SPDX-License-Identifier: Apache-2.0
#include "lab/training/left_out_parts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lab/training/model_training.h"
#include "unit/lab/training/made_reaches.h"

namespace dts::lab::training {
namespace {

using core::TrunkClass;

/// Thirty reaches of class 2 per group, each off by the same.
class LeftOutParts : public testing::Test {
 protected:
  LeftOutParts() {
    for (const double off_deg : {1.0, 2.0, 9.0}) {
      for (int k = 0; k < 30; ++k) {
        ClassifiedReach one{.reach = &reach_, .movement = {}, .group = group_};
        one.movement.trunk_class = TrunkClass::Moderate;
        one.movement.probability = {0.02, 0.95, 0.03};
        one.movement.trunk_deg = reach_.flexion_deg + off_deg;
        classified_.push_back(one);
      }
      ++group_;
    }
  }

  TrainingReach reach_{.wanted = TrunkClass::Moderate, .flexion_deg = 25.0};
  std::size_t group_ = 0;
  std::vector<ClassifiedReach> classified_;
};

TEST_F(LeftOutParts, GroupUnlikeTheOthers_DoesNotWidenItsOwnIntervals) {
  RecordProperty("requirement", "CLS-4");
  EXPECT_DOUBLE_EQ(residuals_of(classified_)[1], 9.0);
  EXPECT_DOUBLE_EQ(residuals_of(classified_, 2)[1], 2.0);
}

TEST_F(LeftOutParts, Forecasts_AreThoseOfTheOtherGroups) {
  EXPECT_EQ(forecasts_of(classified_).size(), 90U);
  EXPECT_EQ(forecasts_of(classified_, 0).size(), 60U);
}

TEST_F(LeftOutParts, ClassNought_OnlyWhereHardlyAnyOtherReachOfClassOneIs) {
  reach_.wanted = TrunkClass::Minor;
  for (ClassifiedReach& one : classified_) {
    one.movement.trunk_class = TrunkClass::None;
    one.arm_alone = one.group == 2 ? 0.97 : 0.6;
  }
  EXPECT_NEAR(none_from_of(classified_), 0.97, 1e-5);
  EXPECT_NEAR(none_from_of(classified_, 2), 0.6, 1e-5);
  EXPECT_EQ(guess_of(classified_.back(), 0.99), TrunkClass::Minor);
  EXPECT_EQ(guess_of(classified_.back(), 0.9), TrunkClass::None);
  classified_.back().movement.trunk_class = TrunkClass::Maximum;
  EXPECT_EQ(guess_of(classified_.back(), 0.9), TrunkClass::Maximum);
}

TEST_F(LeftOutParts, ReachOfTheArmAlone_WidensNothing) {
  TrainingReach alone{.wanted = TrunkClass::None, .flexion_deg = 0.0};
  classified_.assign(1, {.reach = &alone, .movement = {.trunk_deg = 50.0}, .group = 0});
  EXPECT_TRUE(forecasts_of(classified_).empty());
  EXPECT_DOUBLE_EQ(residuals_of(classified_)[2], 0.5);
}

TEST_F(LeftOutParts, Kept_WhenSureInRangeAndWithinTheInterval) {
  core::TrunkMovement movement = classified_.front().movement;
  EXPECT_TRUE(is_kept(movement, {2.0, 2.0, 2.0}, 0.9));
  EXPECT_FALSE(is_kept(movement, {2.0, 2.0, 2.0}, 0.96));
  movement.trunk_deg = 50.0;
  EXPECT_FALSE(is_kept(movement, {2.0, 2.0, 2.0}, 0.9));
  EXPECT_TRUE(is_kept(movement, {2.0, 2.0, 9.0}, 0.9));
  movement.reasons = core::class_reason::kOutOfRange;
  EXPECT_FALSE(is_kept(movement, {2.0, 2.0, 9.0}, 0.9));
  movement.reasons = 0;
  movement.probability.fill(std::nan(""));
  EXPECT_FALSE(is_kept(movement, {2.0, 2.0, 9.0}, 0.9));
}

// One person's angles are off by twelve degrees: the figure must tell that such people are not covered by what others showed.
TEST(TrainModel, PersonUnlikeAllOthers_IsNotCoveredByTheFigure) {
  TrainingSet set = made_reaches(6, 1);
  for (TrainingReach& reach : set.reaches) {
    if (reach.subject == 0 && reach.wanted >= TrunkClass::Minor) reach.flexion_deg += 12.0;
  }

  const auto model = train_model(set, {.networks = 3}, {});

  ASSERT_TRUE(model) << core::to_string(model.error());
  EXPECT_LT(model->form().figures.left_out_angle_coverage, 0.87);
}

}  // namespace
}  // namespace dts::lab::training
