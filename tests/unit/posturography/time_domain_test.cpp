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
using test::Noise;
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

TEST(TimeDomain, OneAxisOnly_AngleIs0Or90AndTheOtherHasNoFrequency) {
  const auto wave = [](std::size_t i) { return 3.0 * std::sin(2.0 * pi * static_cast<double>(i) / 40.0); };

  const Measures forward = time_domain_of(series_of(kRateHz, 400, [&](std::size_t i) { return Position{17.44378, wave(i)}; }));
  const Measures sideways = time_domain_of(series_of(kRateHz, 400, [&](std::size_t i) { return Position{wave(i), 17.44378}; }));

  EXPECT_EQ(forward.get(Measure::EllAngle), 90.0);
  EXPECT_EQ(sideways.get(Measure::EllAngle), 0.0);
  EXPECT_EQ(forward.get(Measure::Pea95F), 0.0);
  EXPECT_EQ(forward.get(Measure::AreaSw), 0.0);
  EXPECT_EQ(forward.get(Measure::AreaHull), 0.0);
  EXPECT_EQ(forward.get(Measure::MdistMl), 0.0);
  EXPECT_TRUE(forward.has(Measure::MfreqAp));
  EXPECT_FALSE(forward.has(Measure::MfreqMl));
  EXPECT_FALSE(sideways.has(Measure::MfreqAp));
  EXPECT_FALSE(forward.has(Measure::FdCe));
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

TEST(TimeDomain, WhiteNoise_HasTheMomentsOfANormalPlane) {
  constexpr std::size_t kCount = 20'000;
  const double sd = 2.5;
  Noise noise(7);
  const CopSeries series = series_of(kRateHz, kCount, [&](std::size_t) { return Position{sd * noise.normal(), sd * noise.normal()}; });

  const Measures measures = time_domain_of(series);

  // Four standard errors of each estimate.
  expect_value(measures, Measure::RdistAp, sd, 4.0 / std::sqrt(2.0 * kCount));
  expect_value(measures, Measure::Mdist, sd * std::sqrt(pi / 2.0), 4.0 * 0.5227 / std::sqrt(1.0 * kCount));
  expect_value(measures, Measure::Totex, (kCount - 1.0) * sd * std::sqrt(pi), 4.0 * 0.5227 * 1.5 / std::sqrt(1.0 * kCount));
  expect_value(measures, Measure::Pea95F, -2.0 * std::log(0.05) * pi * sd * sd, 4.0 / std::sqrt(1.0 * kCount));
  std::size_t inside = 0;
  const double factor = *measures.get(Measure::Pea95F) / (pi * *measures.get(Measure::EllSd1) * *measures.get(Measure::EllSd2));
  for (std::size_t i = 0; i < kCount; ++i) inside += std::hypot(series.ml_mm[i], series.ap_mm[i]) < std::sqrt(factor) * sd ? 1U : 0U;
  EXPECT_NEAR(static_cast<double>(inside) / kCount, 0.95, 4.0 * std::sqrt(0.95 * 0.05 / kCount));
}

TEST(TimeDomain, SlowerNoise_HasLowerMeanFrequency) {
  const auto mean_frequency = [](double memory) {
    Noise noise(3);
    double ml = 0.0;
    double ap = 0.0;
    return *time_domain_of(series_of(kRateHz, 6000, [&](std::size_t) {
              ml = memory * ml + noise.normal();
              ap = memory * ap + noise.normal();
              return Position{ml, ap};
            })).get(Measure::Mfreq);
  };

  const double white = mean_frequency(0.0);
  const double pinkish = mean_frequency(0.9);
  const double brownish = mean_frequency(0.99);

  // Mean step over mean distance of an autoregressive plane is sqrt(2 (1 - memory)).
  EXPECT_NEAR(white, std::numbers::sqrt2 * kRateHz / (2.0 * pi), 0.02 * white);
  // Four standard errors of a mean distance of 6000 (1 - memory^2) / (1 + memory^2) = 630 and 60 independent points.
  EXPECT_NEAR(pinkish, std::sqrt(0.2) * kRateHz / (2.0 * pi), 4.0 * 0.5227 / std::sqrt(630.0) * pinkish);
  EXPECT_NEAR(brownish, std::sqrt(0.02) * kRateHz / (2.0 * pi), 4.0 * 0.5227 / std::sqrt(60.0) * brownish);
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

TEST(TimeDomain, UnfilteredHasNoHeading) {
  EXPECT_FALSE(time_domain_of(turning(10, 10.0, 10.0, 0.0), Profile::AsIs).has(Measure::HcMeanabs));
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
