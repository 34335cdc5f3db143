// SPDX-License-Identifier: Apache-2.0
#include "classifier/reach_feature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace dts::classifier {
namespace {

TEST(ReachFeature, EachOfThem_IsAsDescribedAndFoundByItsName) {
  const core::ReachFeatures reach{
      .p1_mm = 4.0, .p2_mm = 3.0, .p3_mm = 6.0, .hold_mm = 1.0, .rise_s = 0.7, .rest_ratio = -0.3, .ratio_change = 0.2};
  SubjectCalibration subject{.max_d2_mm = 10.0};
  subject.max_hold_mm = 5.0;
  subject.max_ratio_change = 0.8;
  const double expected[] = {1.0, 2.0, 4.0, 3.0, 6.0, 0.25, 0.5, 0.25, 0.7, -0.3, 0.2, 0.1, 0.2, 0.2, 0.25};
  for (int number = 1; number <= 15; ++number) {
    const auto feature = static_cast<ReachFeature>(number);
    EXPECT_NEAR(value_of(feature, reach, &subject), expected[number - 1], 1e-12) << name_of(feature);
    EXPECT_EQ(parse_reach_feature(name_of(feature)), feature);
    EXPECT_EQ(is_own(feature), std::isnan(value_of(feature, reach, nullptr))) << name_of(feature);
    EXPECT_EQ(is_own(feature), std::string(name_of(feature)).ends_with("own_max"));
  }
  EXPECT_TRUE(std::isnan(value_of(ReachFeature::RelativeD1, {.p1_mm = 0.0, .p2_mm = 0.0}, nullptr)));
  EXPECT_EQ(name_of(ReachFeature{}), "unknown");
  EXPECT_FALSE(parse_reach_feature("d1"));
}

}  // namespace
}  // namespace dts::classifier
