// SPDX-License-Identifier: Apache-2.0
#include "lab/study/left_out.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dts::lab::study {
namespace {

/// Twenty reaches of each volunteer, all off by the same.
std::vector<AngleError> errors(const std::vector<double>& off_deg) {
  std::vector<AngleError> all;
  for (std::size_t volunteer = 0; volunteer < off_deg.size(); ++volunteer) {
    for (int k = 0; k < 20; ++k) all.push_back({volunteer, 25.0 + off_deg[volunteer], 25.0});
  }
  return all;
}

TEST(Coverage, VolunteerUnlikeAllOthers_IsNotCoveredByTheirIntervals) {
  EXPECT_DOUBLE_EQ(coverage_left_out(errors({1.0, 1.0, 1.0, 9.0}), 4), 0.75);  // by their own errors it would be all
}

TEST(Coverage, PeopleAlike_AreCovered) { EXPECT_DOUBLE_EQ(coverage_left_out(errors({2.0, 2.0, -2.0}), 3), 1.0); }

TEST(Coverage, OnePersonAlone_HasNone) {
  EXPECT_TRUE(std::isnan(coverage_left_out(errors({2.0}), 1)));
  EXPECT_TRUE(std::isnan(coverage_left_out({}, 5)));
}

}  // namespace
}  // namespace dts::lab::study
