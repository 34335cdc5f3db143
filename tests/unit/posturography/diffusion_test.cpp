// SPDX-License-Identifier: Apache-2.0
#include "posturography/diffusion.h"
#include "unit/posturography/sway_signals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace dts::posturography {
namespace {

Prepared prepared_of(double rate_hz, std::vector<double> ap, std::vector<double> ml) {
  test::centre(ap);
  test::centre(ml);
  return {.rate_hz = rate_hz, .ml_mm = std::move(ml), .ap_mm = std::move(ap)};
}

std::vector<double> random_walk(std::size_t samples, unsigned seed, double step_mm) {
  std::mt19937_64 source(seed);
  std::normal_distribution<double> normal(0.0, step_mm);
  std::vector<double> values(samples);
  double place = 0.0;
  for (double& value : values) value = place += normal(source);
  return values;
}

std::vector<double> series(std::size_t samples, const std::function<double(double)>& at) {
  std::vector<double> values(samples);
  for (std::size_t n = 0; n < samples; ++n) values[n] = at(static_cast<double>(n));
  return values;
}

double direct(const std::vector<double>& values, std::size_t lag) {
  long double sum = 0.0L;
  for (std::size_t n = 0; n + lag < values.size(); ++n) {
    const long double difference = static_cast<long double>(values[n + lag]) - static_cast<long double>(values[n]);
    sum += difference * difference;
  }
  return static_cast<double>(sum / static_cast<long double>(values.size() - lag));
}

void expect_direct(const Prepared& prepared, const DisplacementCurve& curve, std::size_t stride = 1) {
  for (std::size_t k = 1; k < curve.ap_mm2.size(); k += k < 20 ? 1 : stride) {
    const double ap = direct(prepared.ap_mm, k);
    const double ml = direct(prepared.ml_mm, k);
    ASSERT_LE(std::abs(curve.ap_mm2[k] - ap), 1e-9 * ap) << k;
    ASSERT_LE(std::abs(curve.ml_mm2[k] - ml), 1e-9 * ml) << k;
  }
}

Measures measured(const Prepared& prepared, bool with_diffusion = true) {
  Measures measures;
  add_random_walk(prepared, mean_square_displacement(prepared), with_diffusion, measures);
  return measures;
}

TEST(MeanSquareDisplacement, WorkedByHand) {
  const Prepared prepared{.rate_hz = 1.0, .ml_mm = {0, 0, 0, 0, 0}, .ap_mm = {-3, -2, 0, 3, 2}};

  const DisplacementCurve curve = mean_square_displacement(prepared);

  // Steps 1 2 3 -1: 15 / 4; over two 3 5 2: 38 / 3; at most half of five samples.
  ASSERT_EQ(curve.ap_mm2.size(), 3U);
  EXPECT_EQ(curve.ap_mm2[0], 0.0);
  EXPECT_NEAR(curve.ap_mm2[1], 3.75, 1e-14);
  EXPECT_NEAR(curve.ap_mm2[2], 38.0 / 3.0, 1e-13);
  EXPECT_EQ(curve.ml_mm2, std::vector<double>(3));
  EXPECT_EQ(curve.lag_step_s, 1.0);
}

TEST(MeanSquareDisplacement, RandomWalksOfManyLengths_EveryLagIsTheDefinition) {
  for (const std::size_t samples : {2U, 3U, 4U, 7U, 20U, 41U, 200U, 599U, 1999U}) {
    const Prepared prepared = prepared_of(20.0, random_walk(samples, 1, 0.5), random_walk(samples, 2, 1e-3));
    const DisplacementCurve curve = mean_square_displacement(prepared);
    EXPECT_EQ(curve.ap_mm2.size(), std::min<std::size_t>(samples / 2, 200) + 1);
    expect_direct(prepared, curve);
  }
}

TEST(MeanSquareDisplacement, SeveralBlocks_EveryPairCountsOnce) {
  const Prepared prepared = prepared_of(100.0, random_walk(3001, 3, 0.5), random_walk(3001, 4, 0.3));

  const DisplacementCurve curve = mean_square_displacement(prepared, 0.4);

  EXPECT_EQ(curve.ap_mm2.size(), 41U);
  expect_direct(prepared, curve);
}

TEST(MeanSquareDisplacement, LargeBesideSmall_BothKeepTheirDigits) {
  // 1 um of tremor on half a metre of drift: squares are eleven orders larger than what their difference is.
  const auto drift = [](double n) { return 1e-3 * std::sin(2.1 * n) + 250.0 * std::cos(std::numbers::pi * n / 6000.0); };
  for (const Prepared& prepared : {prepared_of(100.0, series(6000, drift), series(6000, [](double n) { return 1e-4 * n; })),
                                   prepared_of(100.0, random_walk(6000, 5, 10.0), random_walk(6000, 6, 1e-6))}) {
    expect_direct(prepared, mean_square_displacement(prepared), 37);
  }
}

TEST(MeanSquareDisplacement, Constant_IsExactlyZero) {
  const Prepared prepared{.rate_hz = 100.0, .ml_mm = std::vector<double>(3000, 1e-17), .ap_mm = std::vector<double>(3000, 0.0)};

  const DisplacementCurve curve = mean_square_displacement(prepared);

  EXPECT_EQ(curve.ap_mm2, std::vector<double>(1001));
  EXPECT_EQ(curve.ml_mm2, std::vector<double>(1001));
}

TEST(MeanSquareDisplacement, Impossible_IsEmpty) {
  EXPECT_TRUE(mean_square_displacement({.rate_hz = 100.0}).ap_mm2.empty());
  EXPECT_TRUE(mean_square_displacement({.rate_hz = 0.0, .ml_mm = {1.0, 2.0}, .ap_mm = {1.0, 2.0}}).ap_mm2.empty());
  EXPECT_TRUE(mean_square_displacement({.rate_hz = 1.0, .ml_mm = {1.0, 2.0}, .ap_mm = {1.0, 2.0}}, std::nan("")).ap_mm2.empty());
  EXPECT_EQ(mean_square_displacement({.rate_hz = 1.0, .ml_mm = {1.0}, .ap_mm = {1.0}}).ap_mm2.size(), 1U);
}

TEST(RandomWalk, StraightWay_DisplacementIsItsSquare) {
  // 3 mm/s and 4 mm/s: MSD = (v tau)^2, H = 1 everywhere, the slope of tau^2 over equally spaced lags is the sum of the ends.
  const Prepared prepared =
      prepared_of(100.0, series(6000, [](double n) { return 0.03 * n; }), series(6000, [](double n) { return 0.04 * n; }));

  const Measures measures = measured(prepared);

  EXPECT_NEAR(measures.get(Measure::Msd100msRes).value(), 0.25, 1e-10);
  EXPECT_NEAR(measures.get(Measure::Msd1sAp).value(), 9.0, 1e-8);
  EXPECT_NEAR(measures.get(Measure::Msd10sMl).value(), 1600.0, 1e-6);
  EXPECT_NEAR(measures.get(Measure::SdaHsRes).value(), 1.0, 1e-9);
  EXPECT_NEAR(measures.get(Measure::SdaHlAp).value(), 1.0, 1e-9);
  EXPECT_NEAR(measures.get(Measure::SdaDsAp).value(), 0.5 * 9.0 * 0.51, 1e-8);
  EXPECT_NEAR(measures.get(Measure::SdaDlMl).value(), 0.5 * 16.0 * 12.0, 1e-6);
  EXPECT_FALSE(measures.has(Measure::SdaTcRes)) << "it never slows down";
}

/// Two straight lines that meet, by default at 1 s: 8 tau, then 8 + slope (tau - 1).
DisplacementCurve bent(double late_slope, double meet_s = 1.0) {
  DisplacementCurve curve{.lag_step_s = 0.01};
  for (int k = 0; k <= 1000; ++k) {
    const double tau_s = 0.01 * k;
    curve.ap_mm2.push_back(tau_s < 1.0 ? 8.0 * tau_s : 8.0 * meet_s + late_slope * (tau_s - meet_s));
    curve.ml_mm2.push_back(0.0);
  }
  return curve;
}

Measures measured(const DisplacementCurve& curve) {
  Measures measures;
  add_random_walk({.rate_hz = 100.0, .ml_mm = std::vector<double>(6000), .ap_mm = std::vector<double>(6000)}, curve, true, measures);
  return measures;
}

TEST(RandomWalk, TwoLines_CriticalPointIsWhereTheyMeet) {
  const Measures measures = measured(bent(2.0));

  EXPECT_NEAR(measures.get(Measure::SdaDsAp).value(), 4.0, 1e-12);
  EXPECT_NEAR(measures.get(Measure::SdaDlAp).value(), 1.0, 1e-12);
  EXPECT_NEAR(measures.get(Measure::SdaTcAp).value(), 1.0, 1e-12);
  EXPECT_NEAR(measures.get(Measure::SdaTcRes).value(), 1.0, 1e-12);
  EXPECT_NEAR(measures.get(Measure::SdaHsAp).value(), 0.5, 1e-12);
}

TEST(RandomWalk, NoCriticalPointWhereItDoesNotSlowDown) {
  EXPECT_NEAR(measured(bent(7.9)).get(Measure::SdaTcAp).value(), 1.0, 1e-9);
  EXPECT_NEAR(measured(bent(2.0, 9.9)).get(Measure::SdaTcAp).value(), 9.9, 1e-9);
  EXPECT_FALSE(measured(bent(2.0, 10.1)).has(Measure::SdaTcAp)) << "they meet beyond the curve";
  EXPECT_FALSE(measured(bent(2.0, -0.1)).has(Measure::SdaTcAp)) << "they meet before it";
  EXPECT_FALSE(measured(bent(8.0)).has(Measure::SdaTcAp)) << "one line";
  EXPECT_FALSE(measured(bent(9.0)).has(Measure::SdaTcAp)) << "it goes faster";
}

TEST(RandomWalk, ConstantAxis_ZeroDisplacementAndNoExponent) {
  const Measures measures = measured(prepared_of(100.0, random_walk(6000, 7, 0.2), std::vector<double>(6000)));

  EXPECT_EQ(measures.get(Measure::Msd1sMl), 0.0);
  EXPECT_EQ(measures.get(Measure::SdaDsMl), 0.0);
  EXPECT_FALSE(measures.has(Measure::SdaHsMl));
  EXPECT_FALSE(measures.has(Measure::SdaHlMl));
  EXPECT_FALSE(measures.has(Measure::SdaTcMl));
  EXPECT_TRUE(measures.has(Measure::SdaHsAp));
  EXPECT_EQ(measures.get(Measure::Msd1sRes), measures.get(Measure::Msd1sAp));
  EXPECT_EQ(measured(prepared_of(100.0, random_walk(6000, 7, 0.2), random_walk(6000, 8, 0.2)), false).count(), 18U) << "displacements only";
}

TEST(RandomWalk, PeriodOfExactlyOneLag_NoExponent) {
  // Every tenth sample is the same: MSD of 0.1 s is 0, whose logarithm is none.
  const Prepared prepared = prepared_of(100.0, series(6000, [](double n) { return std::fmod(n, 10.0); }), random_walk(6000, 8, 1.0));

  const Measures measures = measured(prepared);

  EXPECT_EQ(measures.get(Measure::Msd100msAp), 0.0);
  EXPECT_FALSE(measures.has(Measure::SdaHsAp));
  EXPECT_TRUE(measures.has(Measure::SdaDsAp));
}

TEST(RandomWalk, LagsBeyondHalfTheTrial_AreAbsent) {
  const auto line = [](double n) { return 0.03 * n; };
  const Measures measures = measured(prepared_of(100.0, series(1999, line), series(1999, line)));

  EXPECT_TRUE(measures.has(Measure::Msd5sRes));
  EXPECT_FALSE(measures.has(Measure::Msd10sRes)) << "19.99 s";
  EXPECT_FALSE(measures.has(Measure::SdaDlRes)) << "the long region is not whole";
  EXPECT_FALSE(measures.has(Measure::SdaTcRes)) << "nor are there two lines that meet";
  EXPECT_TRUE(measures.has(Measure::SdaDsRes));
  EXPECT_TRUE(measured(prepared_of(100.0, series(2000, line), series(2000, line))).has(Measure::Msd10sRes));
}

TEST(RandomWalk, LagsBeyondTheCurve_AreAbsent) {
  DisplacementCurve curve = bent(2.0);
  curve.ap_mm2.resize(100);  // 0 .. 0.99 s
  curve.ml_mm2.resize(100);

  EXPECT_NEAR(measured(curve).get(Measure::Msd500msAp).value(), 4.0, 1e-12);
  EXPECT_FALSE(measured(curve).has(Measure::Msd1sAp));
}

TEST(RandomWalk, LowRate_EachLagOnceAndWithinItsRegion) {
  // At 25 Hz 10 ms are a quarter of a sample, and 0.5 s is no whole number of them: lags 1 .. 12 count once each, 13 (0.52 s) does not.
  DisplacementCurve curve{.lag_step_s = 0.04};
  for (int k = 0; k <= 250; ++k) curve.ap_mm2.push_back(k == 13 || k == 49 ? 1e6 : 0.01 * k * k);
  curve.ml_mm2 = curve.ap_mm2;
  Measures measures;
  add_random_walk({.rate_hz = 25.0, .ml_mm = std::vector<double>(1500), .ap_mm = std::vector<double>(1500)}, curve, true, measures);

  // The slope of k^2 over whole numbers is the sum of the ends.
  EXPECT_NEAR(measures.get(Measure::SdaDsAp).value(), 0.5 * 0.01 * (1 + 12) * 25.0, 1e-9);
  EXPECT_NEAR(measures.get(Measure::SdaDlAp).value(), 0.5 * 0.01 * (50 + 250) * 25.0, 1e-9);
  EXPECT_NEAR(measures.get(Measure::SdaHlAp).value(), 1.0, 1e-12);
}

TEST(RandomWalk, LagBetweenTwoSamples_IsTheLaterOne) {
  // At 250 Hz every other multiple of 10 ms lies half way between two lags; 2.9 s are 725, and 2.91 s are 727.5.
  DisplacementCurve curve{.lag_step_s = 0.004, .ap_mm2 = std::vector<double>(2501, 1e6), .ml_mm2 = std::vector<double>(2501)};
  for (std::size_t i = 1; i <= 1000; ++i) curve.ap_mm2[(5 * i + 1) / 2] = 3.0;
  Measures measures;
  add_random_walk({.rate_hz = 250.0, .ml_mm = std::vector<double>(7500), .ap_mm = std::vector<double>(7500)}, curve, true, measures);

  EXPECT_NEAR(measures.get(Measure::SdaDsAp).value(), 0.0, 1e-9);
  EXPECT_NEAR(measures.get(Measure::SdaDlAp).value(), 0.0, 1e-9);
}

TEST(RandomWalk, VeryShort_NothingAndNeverNaN) {
  for (std::size_t samples = 0; samples < 25; ++samples) {
    const Measures measures = measured(prepared_of(100.0, random_walk(samples, 1, 1.0), random_walk(samples, 2, 1.0)));
    EXPECT_EQ(measures.has(Measure::Msd100msAp), samples >= 20) << samples;
    EXPECT_FALSE(measures.has(Measure::SdaDsAp)) << samples;
  }
}

}  // namespace
}  // namespace dts::posturography
