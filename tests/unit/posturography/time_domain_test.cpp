// SPDX-License-Identifier: Apache-2.0
// Curves whose measures are known from geometry.
#include "posturography/time_domain.h"
#include "core/special_numbers.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "posturography/ellipse.h"
#include "unit/posturography/sway_signals.h"

namespace dts::posturography {
namespace {

using std::numbers::pi;
using test::Position;
using test::prepared_of;
using test::series_of;

constexpr double kRateHz = 100.0;

Measures time_domain_of(const CopSeries& series, Profile as = Profile::AsIs) {
  Measures measures;
  const Prepared prepared = prepared_of(series, as);
  add_time_domain(prepared, measures);
  add_velocity_and_direction(prepared, std::nullopt, measures);
  return measures;
}

void expect_value(const Measures& measures, Measure measure, double expected, double relative = 1e-12) {
  ASSERT_TRUE(measures.has(measure)) << info(measure).symbol;
  EXPECT_NEAR(*measures.get(measure), expected, relative * std::max(std::abs(expected), 1e-3)) << info(measure).symbol;
}

/// `turns` rounds of 100 samples each on an ellipse with half axes `along` and `across`, turned by `angle` from +ML.
CopSeries turning(std::size_t turns, double along, double across, double angle) {
  return series_of(kRateHz, 100 * turns, [=](std::size_t i) {
    const double phase = 2.0 * pi * static_cast<double>(i) / 100.0;
    const double u = along * std::cos(phase);
    const double v = across * std::sin(phase);
    return Position{7.0 + u * std::cos(angle) - v * std::sin(angle), -3.0 + u * std::sin(angle) + v * std::cos(angle)};
  });
}

TEST(TimeDomain, CircleAtOneTurnPerSecond) {
  const double radius = 10.0;
  const double step = 2.0 * radius * std::sin(pi / 100.0);

  const Measures measures = time_domain_of(turning(10, radius, radius, 0.0), Profile::Lp10);

  expect_value(measures, Measure::Mdist, radius);
  expect_value(measures, Measure::Rdist, radius);
  expect_value(measures, Measure::RdistAp, radius / std::numbers::sqrt2);
  expect_value(measures, Measure::Maxdist, radius);
  expect_value(measures, Measure::Range, 2.0 * radius);
  expect_value(measures, Measure::RangeAp, 2.0 * radius);
  expect_value(measures, Measure::Sd1Ml, radius * std::sqrt(0.5 * 1000.0 / 999.0));
  expect_value(measures, Measure::Totex, 999.0 * step);
  expect_value(measures, Measure::Mvelo, 99.9 * step);
  expect_value(measures, Measure::AreaCc, pi * radius * radius, 1e-9);
  expect_value(measures, Measure::AreaCe, 3.0 * pi * radius * radius);
  expect_value(measures, Measure::AreaHull, 50.0 * radius * radius * std::sin(pi / 50.0));
  expect_value(measures, Measure::AreaSw, 99.9 * 0.5 * radius * radius * std::sin(pi / 50.0));
  expect_value(measures, Measure::Mfreq, 99.9 * step / (2.0 * pi * radius));
  expect_value(measures, Measure::FdCc, std::log(1000.0) / std::log(1000.0 * 2.0 * radius / (999.0 * step)), 1e-9);
  expect_value(measures, Measure::VmaxAp, radius * std::sin(pi / 50.0) * kRateHz);
  expect_value(measures, Measure::Aamv2sMl, radius * std::sin(pi / 50.0) * kRateHz, 1e-3);
  expect_value(measures, Measure::HcMeanabs, 14.4);
  expect_value(measures, Measure::HcSd, 0.0, 1e-9);
  expect_value(measures, Measure::HcRate, 360.0);
  EXPECT_FALSE(measures.has(Measure::EllAngle)) << "a circle points nowhere";
}

TEST(TimeDomain, EllipseThatPointsForwardAndRight) {
  const double angle = pi / 6.0;

  const Measures measures = time_domain_of(turning(20, 20.0, 5.0, angle));

  const double n = 2000.0;
  const double f = (n - 2.0) / 2.0 * (std::pow(0.05, -2.0 / (n - 2.0)) - 1.0);
  const double factor = 2.0 * (n - 1.0) * (n + 1.0) / (n * (n - 2.0)) * f;
  expect_value(measures, Measure::EllSd1, 20.0 * std::sqrt(0.5 * n / (n - 1.0)));
  expect_value(measures, Measure::EllSd2, 5.0 * std::sqrt(0.5 * n / (n - 1.0)));
  expect_value(measures, Measure::EllAngle, 30.0);
  expect_value(measures, Measure::Pea95F, pi * factor * 50.0 * n / (n - 1.0), 1e-10);
  expect_value(measures, Measure::Pea95Chi2, pi * -2.0 * std::log(0.05) * 50.0 * n / (n - 1.0), 1e-9);
  expect_value(measures, Measure::Range, 40.0);
  expect_value(measures, Measure::Lfs, *measures.get(Measure::Totex) / *measures.get(Measure::Pea95F));
  EXPECT_FALSE(measures.has(Measure::HcMeanabs)) << "not filtered";
}

TEST(TimeDomain, LineAcross_HasNoAreaAndADirection) {
  const Measures measures = time_domain_of(series_of(kRateHz, 1000, [](std::size_t i) {
    const double along = 12.0 * std::sin(2.0 * pi * static_cast<double>(i) / 100.0);
    return Position{along, -along};
  }));

  for (const Measure area : {Measure::AreaCe, Measure::Pea95F, Measure::Pea95Chi2, Measure::EllSd2}) EXPECT_EQ(measures.get(area), 0.0);
  expect_value(measures, Measure::AreaHull, 0.0, 1e-9);
  expect_value(measures, Measure::AreaSw, 0.0, 1e-9);
  expect_value(measures, Measure::EllAngle, -45.0);
  expect_value(measures, Measure::Range, 24.0 * std::numbers::sqrt2);
  EXPECT_FALSE(measures.has(Measure::FdCe));
  EXPECT_FALSE(measures.has(Measure::Lfs));
  EXPECT_TRUE(measures.has(Measure::FdCc));
}

TEST(TimeDomain, SquareWave_MovesInJumps) {
  // 10 periods of 50 samples forward and 50 back: 19 jumps of 8 mm.
  const Measures measures = time_domain_of(series_of(kRateHz, 1000, [](std::size_t i) {
    return Position{0.0, i / 50 % 2 == 0 ? 4.0 : -4.0};
  }));

  expect_value(measures, Measure::MdistAp, 4.0);
  expect_value(measures, Measure::RdistAp, 4.0);
  expect_value(measures, Measure::TotexAp, 19.0 * 8.0);
  expect_value(measures, Measure::MveloAp, 15.2);
  expect_value(measures, Measure::MfreqAp, 152.0 / (4.0 * std::numbers::sqrt2 * 4.0 * 10.0));
  expect_value(measures, Measure::VmaxAp, 800.0);
  expect_value(measures, Measure::Aamv1sAp, 800.0);
}

TEST(TimeDomain, LargestVelocityPerWindow_IsAveragedOverCompleteWindows) {
  // Steps at 1 mm per sample in the second, at 3 mm in the fourth second, and at 50 mm in the one that is not complete.
  const auto speed = [](std::size_t i) { return i < 100 ? 0.0 : i < 200 ? 1.0 : i < 300 ? 0.0 : i < 400 ? 3.0 : 50.0; };
  double position = 0.0;

  const Measures measures = time_domain_of(series_of(kRateHz, 451, [&](std::size_t i) {
    if (i > 0) position += speed(i - 1);
    return Position{position, 0.0};
  }));

  expect_value(measures, Measure::Aamv1sMl, (0.0 + 100.0 + 0.0 + 300.0) / 4.0);
  expect_value(measures, Measure::Aamv2sMl, (100.0 + 300.0) / 2.0);
  EXPECT_FALSE(measures.has(Measure::Aamv5sMl));
  expect_value(measures, Measure::VmaxMl, 5000.0);
}

TEST(TimeDomain, HeadingOfAReversal_Is180AndRestsAreSkipped) {
  // To and fro along AP with rests: every fourth sample is looked at.
  constexpr std::array kPath = {0.0, 1.0, 1.0, 2.0, 1.0, 1.0, 0.0, 1.0};

  const Measures measures = time_domain_of(series_of(kRateHz, 4 * kPath.size(),
                                                     [&](std::size_t i) {
                                                       return Position{1.0, kPath[i / 4]};
                                                     }),
                                           Profile::Lp10);

  // Headings 90 90 -90 -90 90: changes 0, 180, 0, 180.
  expect_value(measures, Measure::HcMeanabs, 90.0);
  expect_value(measures, Measure::HcSd, 90.0);
}

TEST(TimeDomain, FootLengthGivesTheUsedPart) {
  const Prepared prepared = prepared_of(turning(4, 30.0, 10.0, 0.5 * pi));
  Measures measures;
  Measures without;

  add_velocity_and_direction(prepared, 240.0, measures);
  add_velocity_and_direction(prepared, -1.0, without);

  expect_value(measures, Measure::ApUse, 25.0);
  EXPECT_FALSE(without.has(Measure::ApUse));
}

TEST(TimeDomain, NothingThatCanBeMeasured_HasNoMeasures) {
  for (const Prepared& bad : {Prepared{.rate_hz = 100.0, .ml_mm = {1.0}, .ap_mm = {1.0}},
                              Prepared{.rate_hz = 100.0, .ml_mm = {1.0, 2.0, 4.0}, .ap_mm = {1.0, 2.0}},
                              Prepared{.rate_hz = 0.0, .ml_mm = {1.0, 2.0}, .ap_mm = {1.0, 2.0}}}) {
    Measures measures;
    add_time_domain(bad, measures);
    add_velocity_and_direction(bad, 240.0, measures);
    EXPECT_EQ(measures.count(), 0U) << bad.rate_hz;
  }
}

TEST(TimeDomain, TwoSamples_PathButNoEllipse) {
  const Measures measures = time_domain_of(series_of(kRateHz, 2, [](std::size_t i) { return i == 0 ? Position{0, 0} : Position{3, 4}; }));

  expect_value(measures, Measure::Totex, 5.0);
  expect_value(measures, Measure::Mvelo, 5.0 / 0.02);
  expect_value(measures, Measure::Mdist, 2.5);
  expect_value(measures, Measure::Range, 5.0);
  EXPECT_FALSE(measures.has(Measure::Pea95F));
  EXPECT_FALSE(measures.has(Measure::EllAngle));
}

TEST(Ellipse, FactorOfTenSamplesIsTheOneOfTheSheet) {
  const auto ellipse = prediction_ellipse({.ml_ml = 1.0, .ml_ap = 0.0, .ap_ap = 4.0}, 10);

  ASSERT_TRUE(ellipse);
  EXPECT_NEAR(ellipse->factor, 11.04, 0.005);
  EXPECT_EQ(ellipse->sd1_mm, 2.0);
  EXPECT_EQ(ellipse->sd2_mm, 1.0);
  EXPECT_EQ(ellipse->angle_deg, 90.0);
}

TEST(Ellipse, WhatIsNoCovarianceHasNone) {
  EXPECT_FALSE(prediction_ellipse({1.0, 0.0, 1.0}, 2));
  EXPECT_FALSE(prediction_ellipse({-1.0, 0.0, 1.0}, 100));
  EXPECT_FALSE(prediction_ellipse({1.0, core::kNaN, 1.0}, 100));
  EXPECT_FALSE(prediction_ellipse({1.0, 0.0, std::numeric_limits<double>::infinity()}, 100));
  EXPECT_FALSE(prediction_ellipse({1e300, 0.0, 1e300}, 100)) << "an area that is not finite";
  EXPECT_TRUE(prediction_ellipse({0.0, 0.0, 0.0}, 3));
  EXPECT_EQ(prediction_ellipse({1.0, -0.0, 2.0}, 3)->angle_deg, 90.0);
}

}  // namespace
}  // namespace dts::posturography
