// SPDX-License-Identifier: Apache-2.0
#include "lab/resolution/detection.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dts::lab::resolution {
namespace {

/// Values around `mean` with a sample deviation of exactly 1.
std::vector<double> around(double mean) {
  const double off = std::sqrt(7.0 / 8.0);
  std::vector<double> values;
  for (int k = 0; k < 8; ++k) values.push_back(mean + (k % 2 == 0 ? off : -off));
  return values;
}

Series series_of(std::vector<Level> levels) { return {.none = around(0.0), .levels = std::move(levels)}; }
Level level(double turn_deg, double mean) { return {.turn_deg = turn_deg, .values = around(mean)}; }

// The difference of two single reaches has the deviation sqrt(2): 5 % errors on both sides need 2 x 1.6449 x sqrt(2) = 4.652.
constexpr double kNeeded = 4.652;

TEST(DetectionLimit, OneReach_IsTheDifferenceWithFivePercentErrorsOnBothSides) {
  const Series series = series_of({level(1.0, 1.0), level(4.0, 4.0), level(10.0, 10.0)});
  const auto limit = detection_limit({{series}}, 1);

  ASSERT_TRUE(limit);
  EXPECT_NEAR(*limit, kNeeded, 1e-3);
}

TEST(DetectionLimit, NineReaches_AThird) {
  const Series series = series_of({level(1.0, 1.0), level(4.0, 4.0), level(10.0, 10.0)});

  EXPECT_NEAR(*detection_limit({{series}}, 9), kNeeded / 3.0, 1e-3);
}

TEST(DetectionLimit, LaterLevelThatFallsBack_LimitIsBehindIt) {
  const Series series = series_of({level(1.0, 9.0), level(2.0, 0.0), level(3.0, 9.0)});
  const auto limit = detection_limit({{series}}, 1);

  ASSERT_TRUE(limit);
  EXPECT_GT(*limit, 2.0);
  EXPECT_LT(*limit, 3.0);
}

TEST(DetectionLimit, NothingIsLargeEnough_Empty) {
  EXPECT_FALSE(detection_limit({{series_of({level(1.0, 1.0), level(20.0, 4.0)})}}, 1));
  EXPECT_FALSE(detection_limit({}, 1));
}

TEST(DetectionLimit, SeveralSeries_TheBestCountsAtThePriceOfAHigherThreshold) {
  const Series blind = series_of({level(1.0, 0.0), level(10.0, 0.0)});
  const Series seeing = series_of({level(1.0, 1.0), level(10.0, 10.0)});
  const std::vector<Series> both{blind, seeing};

  // 1.9600 for half of 5 %, and 1.6449, times sqrt(2).
  EXPECT_NEAR(*detection_limit(both, 1), 5.098, 1e-3);
}

TEST(DetectionLimit, Interval_HoldsTheValueAndRepeats) {
  const Series series = series_of({level(1.0, 1.0), level(4.0, 4.0), level(10.0, 10.0)});
  const LimitInterval one = with_interval({{series}}, 1, 7);
  const LimitInterval again = with_interval({{series}}, 1, 7);

  ASSERT_TRUE(one.lowest && one.value && one.highest);
  EXPECT_LT(*one.lowest, *one.value);
  EXPECT_GT(*one.highest, *one.value);
  EXPECT_EQ(one.lowest, again.lowest);
  EXPECT_EQ(one.highest, again.highest);
}

TEST(DetectionLimit, Quantile_CountsUnknownLimitsAsTheLargest) {
  EXPECT_EQ(quantile({3.0, 1.0, 2.0}, 0.5), Limit(2.0));
  EXPECT_EQ(quantile({1.0, 2.0}, 0.5), Limit(1.5));
  EXPECT_EQ(quantile({std::nullopt, 1.0, 2.0}, 0.5), Limit(2.0));
  EXPECT_EQ(quantile({std::nullopt, std::nullopt, 2.0}, 0.5), std::nullopt);
  EXPECT_EQ(quantile({1.0, 2.0, std::nullopt}, 0.9), std::nullopt);
  EXPECT_EQ(quantile({}, 0.5), std::nullopt);
}

}  // namespace
}  // namespace dts::lab::resolution
