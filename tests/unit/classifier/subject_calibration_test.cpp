// SPDX-License-Identifier: Apache-2.0
#include "classifier/subject_calibration.h"

#include <gtest/gtest.h>

#include <vector>

#include "unit/classifier/hand_made_model.h"

namespace dts::classifier {
namespace {

using Reaches = std::vector<core::ReachFeatures>;

TEST(CalibrateSubject, ThreeMaximumReaches_MedianIsTheScale) {
  const auto subject = calibrate_subject(Reaches{reach_of(0.5), reach_of(0.6), reach_of(0.55)}, 54.0).value();

  EXPECT_NEAR(subject.max_d2_mm, 0.55 * 3.5, 1e-12);
  EXPECT_NEAR(subject.max_hold_mm, 0.9 * 0.55 * 3.5, 1e-12);
  EXPECT_NEAR(subject.max_ratio_change, 0.55 / 4.0, 1e-12);
  EXPECT_EQ(subject.max_flexion_deg, 54.0);
}

TEST(CalibrateSubject, OneStrayReach_DoesNotMoveTheScale) {
  const auto subject = calibrate_subject(Reaches{reach_of(0.5), reach_of(0.2), reach_of(0.52)}, 54.0);

  ASSERT_TRUE(subject);
  EXPECT_NEAR(subject->max_d2_mm, 0.5 * 3.5, 1e-12);
}

TEST(CalibrateSubject, UnfitReaches_Refused) {
  auto unknown = reach_of(0.5);
  unknown.p3_mm = core::ReachFeatures::kUnknown;

  EXPECT_FALSE(calibrate_subject(Reaches{reach_of(0.5), reach_of(0.5)}, 54.0));
  EXPECT_FALSE(calibrate_subject(Reaches{reach_of(0.5), reach_of(0.04), reach_of(0.5)}, 54.0));
  EXPECT_FALSE(calibrate_subject(Reaches{reach_of(0.5), unknown, reach_of(0.5)}, 54.0));
  EXPECT_FALSE(calibrate_subject(Reaches{reach_of(0.2), reach_of(0.4), reach_of(0.7)}, 54.0));
}

TEST(CalibrateSubject, FlexionThatIsNone_Refused) {
  const Reaches reaches{reach_of(0.5), reach_of(0.5), reach_of(0.5)};

  EXPECT_FALSE(calibrate_subject(reaches, 0.0));
  EXPECT_FALSE(calibrate_subject(reaches, 90.1));
  EXPECT_FALSE(calibrate_subject(reaches, core::ReachFeatures::kUnknown));
  EXPECT_TRUE(calibrate_subject(reaches, 90.0));
}

TEST(CalibrateSubject, UnknownRatio_IsUnknownInTheScale) {
  auto reach = reach_of(0.5);
  reach.ratio_change = core::ReachFeatures::kUnknown;

  const auto subject = calibrate_subject(Reaches{reach, reach_of(0.5), reach_of(0.5)}, 54.0).value();

  EXPECT_FALSE(subject.max_ratio_change == subject.max_ratio_change);
  EXPECT_NEAR(subject.max_d2_mm, 0.5 * 3.5, 1e-12);
}

}  // namespace
}  // namespace dts::classifier
