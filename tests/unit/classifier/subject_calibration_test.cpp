// SPDX-License-Identifier: Apache-2.0
#include "classifier/subject_calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "unit/classifier/hand_made_model.h"

namespace dts::classifier {
namespace {

std::vector<core::ReachFeatures> reaches(const std::vector<double>& relative_d2) {
  std::vector<core::ReachFeatures> made;
  for (const double d2 : relative_d2) made.push_back(reach_of(d2));
  return made;
}

TEST(CalibrateSubject, MaximumReaches_MedianIsTheScale) {
  const std::vector<std::pair<std::vector<double>, double>> rows{
      {{0.5, 0.6, 0.55}, 0.55}, {{0.5, 0.2, 0.52}, 0.5}, {{0.52, 0.7, 0.5, 0.56}, 0.54}, {{0.05, 0.05, 0.051}, 0.05}};
  for (const auto& [made, median] : rows) {
    const auto subject = calibrate_subject(reaches(made), 54.0).value();

    EXPECT_NEAR(subject.max_d2_mm, median * 3.5, 1e-12);
    EXPECT_NEAR(subject.max_hold_mm, 0.9 * median * 3.5, 1e-12);
    EXPECT_NEAR(subject.max_ratio_change, median / 4.0, 1e-12);
    EXPECT_EQ(subject.max_flexion_deg, 54.0);
    EXPECT_NEAR(subject.maximum.p3_mm, 3.5 * (1.0 + median), 1e-12);
  }
}

TEST(CalibrateSubject, ReachesThatDiffer_NeedTwoInThreeNearTheMedian) {
  EXPECT_TRUE(calibrate_subject(reaches({0.5, 0.351, 0.649}), 54.0));
  EXPECT_TRUE(calibrate_subject(reaches({0.5, 0.349, 0.649}), 54.0));
  EXPECT_FALSE(calibrate_subject(reaches({0.5, 0.349, 0.651}), 54.0));
}

TEST(CalibrateSubject, UnfitReaches_Refused) {
  auto unknown = reaches({0.5, 0.5, 0.5});
  unknown[1].p3_mm = core::ReachFeatures::kUnknown;
  auto weightless = reaches({0.5, 0.5, 0.5});
  weightless[1].p1_mm = 0.0;

  EXPECT_FALSE(calibrate_subject(reaches({0.5, 0.5}), 54.0));
  EXPECT_FALSE(calibrate_subject(reaches({0.05, 0.0499, 0.05}), 54.0));
  EXPECT_FALSE(calibrate_subject(unknown, 54.0));
  EXPECT_FALSE(calibrate_subject(weightless, 54.0));
  for (const double flexion_deg : {0.0, 90.1, core::ReachFeatures::kUnknown})
    EXPECT_FALSE(calibrate_subject(reaches({0.5, 0.5, 0.5}), flexion_deg));
  EXPECT_TRUE(calibrate_subject(reaches({0.5, 0.5, 0.5}), 90.0));
}

TEST(CalibrateSubject, UnknownRatio_IsUnknownInTheScale) {
  auto made = reaches({0.5, 0.5, 0.5});
  made[0].ratio_change = core::ReachFeatures::kUnknown;

  const auto subject = calibrate_subject(made, 54.0).value();

  EXPECT_TRUE(std::isnan(subject.max_ratio_change));
  EXPECT_NEAR(subject.max_d2_mm, 0.5 * 3.5, 1e-12);
}

}  // namespace
}  // namespace dts::classifier
