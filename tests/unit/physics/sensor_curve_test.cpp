// SPDX-License-Identifier: Apache-2.0
#include "physics/sensor_curve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/special_numbers.h"

namespace dts::physics {
namespace {

using core::kInfinity;
using core::kNaN;
using testing::AllOf;
using testing::HasSubstr;

/// The promise of sensor_curve.h.
constexpr double kRoundTripMm = 1e-4;

std::vector<CurvePoint> falling() { return {{{4.0}, {7.4}}, {{6.0}, {5.0}}, {{8.0}, {3.2}}, {{10.0}, {1.8}}, {{12.0}, {0.9}}}; }

/// A reflective sensor closer than its peak: output rises with the gap. Nearly flat and steep stretches follow each other.
std::vector<CurvePoint> rising_and_uneven() { return {{{0.5}, {0.1}}, {{0.7}, {0.15}}, {{1.0}, {2.0}}, {{3.0}, {2.4}}, {{3.1}, {4.0}}}; }

SensorCurve make_curve(std::vector<CurvePoint> points) { return *SensorCurve::create("test", std::move(points)); }

double largest_round_trip_error_mm(const SensorCurve& curve) {
  constexpr int kSteps = 30'011;
  const double first = curve.minimum_gap().value;
  const double span = curve.maximum_gap().value - first;
  double largest = 0.0;
  for (int k = 0; k <= kSteps; ++k) {
    const double gap = first + span * k / kSteps;
    const double error = std::abs(curve.gap(curve.volts({gap})).value - gap);
    if (!(error <= largest)) largest = error;
  }
  return largest;
}

void expect_monotone(const SensorCurve& curve, double sign) {
  const double first = curve.minimum_gap().value;
  const double span = curve.maximum_gap().value - first;
  double before = curve.volts({first}).value;
  for (int k = 1; k <= 20'000; ++k) {
    const double here = curve.volts({first + span * k / 20'000}).value;
    ASSERT_GT(sign * (here - before), 0.0) << k;
    before = here;
  }
}

TEST(SensorCurve, CalibrationPoints_AreMet) {
  for (const auto& points : {falling(), rising_and_uneven()}) {
    const SensorCurve curve = make_curve(points);
    for (const auto& [gap, volts] : points) {
      EXPECT_NEAR(curve.gap(volts).value, gap.value, kRoundTripMm);
      EXPECT_NEAR(curve.volts(gap).value, volts.value, 2e-3);
    }
  }
}

TEST(SensorCurve, BetweenThePoints_IsMonotoneAndThereAndBackReturnsTheGap) {
  for (const SensorCurve& curve : {make_curve(falling()), make_curve(rising_and_uneven()), SensorCurve::hoa1405_assumed()}) {
    expect_monotone(curve, curve.volts(curve.maximum_gap()).value > curve.volts(curve.minimum_gap()).value ? 1.0 : -1.0);
    EXPECT_LT(largest_round_trip_error_mm(curve), kRoundTripMm);
  }
}

TEST(SensorCurve, TwoPoints_AreAStraightLine) {
  const SensorCurve curve = make_curve({{{5.0}, {4.0}}, {{9.0}, {2.0}}});

  EXPECT_NEAR(curve.volts({6.0}).value, 3.5, 1e-12);
  EXPECT_NEAR(curve.gap({2.5}).value, 8.0, 1e-12);
}

TEST(SensorCurve, Hoa1405_FollowsItsParabolaOverItsWorkingRange) {
  RecordProperty("requirement", "SIG-1");
  // Monotone cubics lose an order of accuracy at the ends only; 0.25 mm apart that is far below the sensor's noise of 3 mV.
  const SensorCurve curve = SensorCurve::hoa1405_assumed();

  EXPECT_EQ(curve.minimum_gap().value, 4.0);
  EXPECT_EQ(curve.maximum_gap().value, 13.0);
  for (double gap = 4.0; gap <= 13.0; gap += 0.01) {
    const double z = 12.0 - gap;
    EXPECT_NEAR(curve.volts({gap}).value, 0.9 + 0.35 * z + 0.058 * z * z, 2e-4) << gap;
  }
}

TEST(SensorCurve, Outside_CountsAsTheEndAndNotANumberStaysOne) {
  const SensorCurve curve = make_curve(falling());

  EXPECT_EQ(curve.volts({-1e300}).value, 7.4);
  EXPECT_EQ(curve.volts({kInfinity}).value, 0.9);
  EXPECT_EQ(curve.gap({100.0}).value, 4.0);
  EXPECT_EQ(curve.gap({-kInfinity}).value, 12.0);
  EXPECT_TRUE(curve.contains({0.9}));
  EXPECT_TRUE(curve.contains({7.4}));
  EXPECT_FALSE(curve.contains({7.4001}));
  EXPECT_FALSE(curve.contains({0.8999}));
  EXPECT_TRUE(std::isnan(curve.volts({kNaN}).value));
  EXPECT_TRUE(std::isnan(curve.gap({kNaN}).value));
  EXPECT_FALSE(curve.contains({kNaN}));
}

void expect_curve_refused(std::vector<CurvePoint> points, const char* where, const char* why) {
  const auto result = SensorCurve::create("w3", std::move(points));

  ASSERT_FALSE(result) << why;
  EXPECT_EQ(result.error().code, core::ErrorCode::InvalidArgument);
  EXPECT_THAT(result.error().what, AllOf(HasSubstr("'w3'"), HasSubstr(where), HasSubstr(why)));
}

TEST(SensorCurveInput, WhatIsNoCurve_IsRefusedWithThePoint) {
  expect_curve_refused({}, "0 points", "at least 2");
  expect_curve_refused({{{4.0}, {1.0}}}, "1 points", "at least 2");
  expect_curve_refused({{{4.0}, {3.0}}, {{4.0}, {2.0}}}, "point 1 (4 mm, 2 V)", "gap");
  expect_curve_refused({{{4.0}, {3.0}}, {{5.0}, {2.0}}, {{4.5}, {1.0}}}, "point 2 (4.5 mm, 1 V)", "gap");
  expect_curve_refused({{{4.0}, {3.0}}, {{5.0}, {2.0}}, {{6.0}, {2.5}}}, "point 2 (6 mm, 2.5 V)", "one gap");
  expect_curve_refused({{{4.0}, {3.0}}, {{5.0}, {2.0}}, {{6.0}, {2.0}}}, "point 2", "one gap");
  expect_curve_refused({{{4.0}, {1.0}}, {{5.0}, {2.0}}, {{6.0}, {1.5}}}, "point 2", "one gap");
  expect_curve_refused({{{4.0}, {1.0}}, {{5.0}, {1.0}}}, "point 1", "one gap");
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    expect_curve_refused({{{4.0}, {3.0}}, {{bad}, {2.0}}}, "point 1", "finite");
    expect_curve_refused({{{4.0}, {bad}}, {{5.0}, {2.0}}}, "point 0", "finite");
  }
  expect_curve_refused({{{4.0}, {3.0}}, {{5.0}, {3.0 - 1e-9}}, {{6.0}, {1.0}}}, "nearly flat", "above 5e-05 mm");
  expect_curve_refused({{{-1e308}, {3.0}}, {{1e308}, {2.0}}}, "mm", "");
  expect_curve_refused({{{4.0}, {-1e308}}, {{5.0}, {0.0}}, {{6.0}, {1e308}}}, "mm", "");
}

}  // namespace
}  // namespace dts::physics
