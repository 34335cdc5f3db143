// SPDX-License-Identifier: Apache-2.0
#include "posturography/running_sway.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "posturography/time_domain.h"
#include "unit/posturography/sway_signals.h"

namespace dts::posturography {
namespace {

/// Sway of some mm, far from the origin.
CopSeries random_path(std::size_t samples, double offset_mm, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> step(0.0, 0.3);
  CopSeries path{.rate_hz = 100.0};
  double ml = 0.0;
  double ap = 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    ml = 0.98 * ml + step(random);
    ap = 0.99 * ap + 0.5 * ml + step(random);
    path.ml_mm.push_back(offset_mm + ml);
    path.ap_mm.push_back(ap - 2.0 * offset_mm);
  }
  return path;
}

RunningSwaySums sums_of(const CopSeries& path) {
  RunningSwaySums sums(path.rate_hz);
  for (std::size_t i = 0; i < path.ml_mm.size(); ++i) sums.add(path.ml_mm[i], path.ap_mm[i]);
  return sums;
}

void expect_relative(double actual, double expected, double tolerance) {
  EXPECT_NEAR(actual, expected, tolerance * std::max(1e-300, std::abs(expected)));
}

TEST(RunningSway, ThreeSamples_AreAsByHand) {
  RunningSwaySums sums(50.0);
  sums.add(10.0, 20.0);
  sums.add(13.0, 24.0);
  sums.add(10.0, 28.0);

  const core::RunningSway values = sums.values();

  EXPECT_EQ(values.samples, 3U);
  EXPECT_DOUBLE_EQ(values.mean_ml_mm, 11.0);
  EXPECT_DOUBLE_EQ(values.mean_ap_mm, 24.0);
  EXPECT_DOUBLE_EQ(values.totex_mm, 10.0);  // two sides of 3, 4, 5
  EXPECT_DOUBLE_EQ(values.totex_ml_mm, 6.0);
  EXPECT_DOUBLE_EQ(values.totex_ap_mm, 8.0);
  EXPECT_DOUBLE_EQ(values.range_ml_mm, 3.0);
  EXPECT_DOUBLE_EQ(values.range_ap_mm, 8.0);
  EXPECT_DOUBLE_EQ(values.rdist_ml_mm, std::sqrt(2.0));  // deviations -1, 2, -1
  EXPECT_DOUBLE_EQ(values.rdist_ap_mm, std::sqrt(32.0 / 3.0));
  EXPECT_DOUBLE_EQ(values.rdist_mm, std::sqrt(38.0 / 3.0));
  EXPECT_DOUBLE_EQ(values.ellipse_sd1_mm, 4.0);  // covariance 0: 4 * (-1) + 4 * (-1) ... = 0, variances 16 and 3
  EXPECT_DOUBLE_EQ(values.ellipse_sd2_mm, std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(values.ellipse_angle_deg, 90.0);
  // pi sqrt(48) (N^2 - 1)/N (0.05^(-2/(N-2)) - 1) = pi 6.9282 8/3 399
  expect_relative(values.pea95_f_mm2, 3.14159265358979324 * std::sqrt(48.0) * 8.0 / 3.0 * 399.0, 1e-12);
}

TEST(RunningSway, FewerThanThreeSamples_HaveNoEllipse) {
  RunningSwaySums sums(100.0);
  EXPECT_EQ(sums.values().samples, 0U);
  EXPECT_EQ(sums.values().rate_hz, 100.0);
  EXPECT_EQ(sums.values().totex_mm, 0.0);
  sums.add(1.0, 2.0);
  EXPECT_EQ(sums.values().ellipse_sd1_mm, 0.0);
  EXPECT_EQ(sums.values().rdist_mm, 0.0);
  sums.add(2.0, 2.0);
  EXPECT_EQ(sums.values().pea95_f_mm2, 0.0);
  EXPECT_DOUBLE_EQ(sums.values().totex_mm, 1.0);
  sums.reset();
  EXPECT_EQ(sums, RunningSwaySums(100.0));
}

TEST(RunningSway, RandomPathsFarFromTheOrigin_AreTheFinalMeasures) {
  for (const double offset_mm : {0.0, 200.0, 5000.0}) {
    const CopSeries path = random_path(6000, offset_mm, 7);
    const Prepared prepared = test::prepared_of(path);
    Measures measures;
    add_time_domain(prepared, measures);

    const core::RunningSway values = sums_of(path).values();

    EXPECT_EQ(values.samples, 6000U);
    expect_relative(values.mean_ml_mm, prepared.mean_ml_mm, 1e-12);
    expect_relative(values.mean_ap_mm, prepared.mean_ap_mm, 1e-12);
    for (const auto& [value, measure] : {std::pair{values.rdist_mm, Measure::Rdist},
                                         {values.rdist_ap_mm, Measure::RdistAp},
                                         {values.rdist_ml_mm, Measure::RdistMl},
                                         {values.totex_mm, Measure::Totex},
                                         {values.totex_ap_mm, Measure::TotexAp},
                                         {values.totex_ml_mm, Measure::TotexMl},
                                         {values.range_ap_mm, Measure::RangeAp},
                                         {values.range_ml_mm, Measure::RangeMl},
                                         {values.ellipse_sd1_mm, Measure::EllSd1},
                                         {values.ellipse_sd2_mm, Measure::EllSd2},
                                         {values.ellipse_angle_deg, Measure::EllAngle},
                                         {values.pea95_f_mm2, Measure::Pea95F}}) {
      SCOPED_TRACE(info(measure).symbol);
      expect_relative(value, measures.get(measure).value(), 1e-10);
    }
  }
}

TEST(RunningSway, StandingPerfectlyStill_IsZeroAndNotANumberNowhere) {
  RunningSwaySums sums(100.0);
  for (int i = 0; i < 1000; ++i) sums.add(123.456, -7.89);

  const core::RunningSway values = sums.values();

  EXPECT_EQ(values.totex_mm, 0.0);
  EXPECT_EQ(values.rdist_mm, 0.0);
  EXPECT_EQ(values.pea95_f_mm2, 0.0);
  EXPECT_TRUE(std::isfinite(values.ellipse_angle_deg));
}

TEST(RunningSway, WayOverAnInterruption_IsNoPath) {
  RunningSwaySums sums(100.0);
  sums.interrupt();  // nothing to interrupt yet
  sums.add(0.0, 0.0);
  sums.add(3.0, 4.0);
  sums.interrupt();
  sums.add(100.0, 100.0);
  sums.add(100.0, 101.0);

  EXPECT_DOUBLE_EQ(sums.values().totex_mm, 6.0);
  EXPECT_DOUBLE_EQ(sums.values().totex_ml_mm, 3.0);
  EXPECT_DOUBLE_EQ(sums.values().totex_ap_mm, 5.0);
  EXPECT_DOUBLE_EQ(sums.values().range_ml_mm, 100.0);  // places count
}

TEST(RunningSway, StateTakenAway_GoesOnTheSame) {
  RunningSwaySums one = sums_of(random_path(100, 300.0, 5));
  RunningSwaySums other(100.0);

  ASSERT_TRUE(other.set_state(one.state()));

  one.add(1.0, 2.0);
  other.add(1.0, 2.0);
  EXPECT_EQ(one, other);
  ASSERT_TRUE(other.set_state(RunningSwaySums(100.0).state()));
  EXPECT_EQ(other, RunningSwaySums(100.0));
}

TEST(RunningSway, ImpossibleState_IsRefusedAndLeavesFreshSums) {
  const auto good = sums_of(random_path(100, 300.0, 5)).state();
  struct Bad {
    std::size_t number;
    double value;
  };
  std::vector<Bad> bad{{0, -1.0}, {0, 1.5}, {0, 1e17}, {3, -1e-9}, {4, -1.0}, {6, -1.0}, {7, -1e-3}, {8, -1.0}, {15, 0.5}};
  bad.insert(bad.end(), {{11, 1e6}, {12, -1e6}, {13, 1e6}, {14, -1e6}, {9, 1e6}, {10, -1e6}});  // extremes that leave out the last sample
  bad.push_back({0, 0.0});                                                                      // no samples, but sums
  for (std::size_t number = 0; number < good.size(); ++number) {
    for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
      bad.push_back({number, value});
    }
  }
  for (const Bad& damage : bad) {
    auto state = good;
    state[damage.number] = damage.value;
    RunningSwaySums sums = sums_of(random_path(10, 1.0, 2));
    EXPECT_FALSE(sums.set_state(state)) << "number " << damage.number << " = " << damage.value;
    EXPECT_EQ(sums, RunningSwaySums(100.0));
  }
}

}  // namespace
}  // namespace dts::posturography
