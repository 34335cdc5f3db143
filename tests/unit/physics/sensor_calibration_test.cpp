// SPDX-License-Identifier: Apache-2.0
#include "physics/sensor_calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace dts::physics {
namespace {

using Curve = std::function<double(double)>;

/// plate-model section 5: V = 0.9 + 0.35 z + 0.058 z^2, z = 12 mm - gap.
double assumed_v(double gap_mm) {
  const double z = 12.0 - gap_mm;
  return 0.9 + 0.35 * z + 0.058 * z * z;
}

/// Other shapes that reflective sensors have beyond their peak; no polynomials.
double inverse_square_v(double gap_mm) { return 150.0 / (gap_mm * gap_mm); }
double exponential_v(double gap_mm) { return 12.0 * std::exp(-gap_mm / 4.0); }
double bell_v(double gap_mm) { return 8.0 * gap_mm / 3.0 * std::exp(1.0 - gap_mm / 3.0); }

/// Rounds of readings over 12, 12 - step .. 7 mm with white noise.
std::vector<GapReading> readings(const Curve& curve, double step_mm, int rounds = 1, double noise_v = 0.0) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<GapReading> rows;
  for (int round = 0; round < rounds; ++round) {
    for (double gap_mm = 12.0; gap_mm > 6.999; gap_mm -= step_mm) {
      rows.push_back({.gap = {gap_mm}, .volts = {curve(gap_mm) + noise_v * noise(random)}, .row = rows.size() + 1});
    }
  }
  return rows;
}

std::string calibration_refusal(const std::vector<GapReading>& rows) {
  const auto calibration = calibrate_sensor(rows);
  return calibration ? "" : core::to_string(calibration.error());
}

TEST(SensorCalibration, CleanReadings_BecomePointsOfRisingGap) {
  const auto calibration = calibrate_sensor(readings(assumed_v, 1.0));

  ASSERT_TRUE(calibration) << core::to_string(calibration.error());
  ASSERT_EQ(calibration->points.size(), 6U);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_DOUBLE_EQ(calibration->points[k].gap.value, 7.0 + static_cast<double>(k));
    EXPECT_DOUBLE_EQ(calibration->points[k].volts.value, assumed_v(7.0 + static_cast<double>(k)));
  }
  EXPECT_EQ(calibration->least_readings, 1U);
  EXPECT_FALSE(calibration->repeat_v.has_value());
  EXPECT_NEAR(calibration->residual_v, 0.0, 1e-9);  // the assumed curve is a quadratic
}

TEST(SensorCalibration, RepeatedReadings_AreAveragedAndTheirScatterTold) {
  const auto calibration = calibrate_sensor(readings(assumed_v, 0.5, 20, 0.003));

  ASSERT_TRUE(calibration) << core::to_string(calibration.error());
  EXPECT_EQ(calibration->points.size(), 11U);
  EXPECT_EQ(calibration->least_readings, 20U);
  EXPECT_NEAR(calibration->repeat_v.value(), 0.003, 0.0006);  // 209 degrees of freedom: 5 % deviation, four of them
  for (const CurvePoint& point : calibration->points)
    EXPECT_NEAR(point.volts.value, assumed_v(point.gap.value), 4.0 * 0.003 / std::sqrt(20.0));
}

TEST(SensorCalibration, ShapesThatAreNoPolynomials_Accepted) {
  for (const Curve& curve : {Curve(inverse_square_v), Curve(exponential_v), Curve(bell_v)}) {
    for (const double step_mm : {1.25, 1.0, 0.5, 0.25}) EXPECT_EQ(calibration_refusal(readings(curve, step_mm, 1, 0.003)), "") << step_mm;
  }
}

TEST(SensorCalibration, RisingSensor_AcceptedToo) {
  EXPECT_EQ(calibration_refusal(readings([](double gap_mm) { return -assumed_v(gap_mm); }, 1.0)), "");
}

TEST(SensorCalibration, EachGapReadAtTheNextSpacer_NamedWhicheverItIs) {
  for (const Curve& curve : {Curve(assumed_v), Curve(inverse_square_v), Curve(exponential_v)}) {
    for (std::size_t wrong = 0; wrong < 11; ++wrong) {
      auto rows = readings(curve, 0.5, 1, 0.001);
      const double neighbour_mm = rows[wrong].gap.value + (wrong + 1 < rows.size() ? -1.0 : 1.0);
      rows[wrong].volts = {curve(neighbour_mm)};

      const std::string what = calibration_refusal(rows);

      EXPECT_EQ(what.rfind("row " + std::to_string(wrong + 1) + " (gap ", 0), 0U) << wrong << ": " << what;
      EXPECT_NE(what.find("expected"), std::string::npos);
    }
  }
}

TEST(SensorCalibration, OneReadingThatDoesNotRepeat_Named) {
  auto rows = readings(assumed_v, 1.0, 3, 0.003);
  rows[8].volts.value += 0.1;  // gap 10 mm, second round

  EXPECT_EQ(calibration_refusal(rows).rfind("row 9 (gap 10 mm, ", 0), 0U) << calibration_refusal(rows);
}

TEST(SensorCalibration, BeyondThePeak_RefusedAsNotMonotone) {
  std::vector<GapReading> rows;
  for (double gap_mm = 10.0; gap_mm > 0.99; gap_mm -= 0.5)
    rows.push_back({.gap = {gap_mm}, .volts = {bell_v(gap_mm)}, .row = rows.size() + 1});

  const std::string what = calibration_refusal(rows);

  EXPECT_NE(what.find("does not keep"), std::string::npos) << what;
  EXPECT_NE(what.find("peak"), std::string::npos) << what;
}

TEST(SensorCalibration, FewGapsOrNoNumbers_Refused) {
  EXPECT_NE(calibration_refusal({}).find("0 different gaps, at least 5"), std::string::npos);
  EXPECT_NE(calibration_refusal(readings(assumed_v, 5.0 / 3.0)).find("4 different gaps"), std::string::npos);
  auto rows = readings(assumed_v, 1.0);
  rows[2].volts.value = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(calibration_refusal(rows).find("row 3 is not a finite number"), std::string::npos);
}

TEST(SensorCalibration, VoltsWithoutAnyOrder_Refused) {
  auto rows = readings(assumed_v, 1.0, 2);
  std::mt19937_64 random(3);
  for (GapReading& row : rows) row.volts = {static_cast<double>(random() >> 11) * 0x1p-53 * 4.0};

  EXPECT_NE(calibration_refusal(rows), "");
}

}  // namespace
}  // namespace dts::physics
