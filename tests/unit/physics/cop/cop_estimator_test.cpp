// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/cop_estimator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/special_numbers.h"
#include "physics/cop/cop_trials.h"
#include "unit/physics/floor_platform.h"

namespace dts::physics {
namespace {

using test::at;
using test::corners;
using test::floor_rig;
using test::RefinedPlate;
using test::sample_of;

constexpr double kLoadN = 490.0;  // thesis 4.5: 50 kgf
using core::kInfinity;
using core::kNaN;

RefinedPlate floor_plate(double inset_mm) { return {test::steel_plate(), corners(inset_mm), test::floor_sensors()}; }

InfluenceTable meshed_plate(double inset_mm) {
  return *InfluenceTable::create(test::steel_plate(), corners(inset_mm), test::floor_sensors());
}

struct Deviation {
  double x_mm = 0.0;
  double y_mm = 0.0;

  [[nodiscard]] double total() const { return std::hypot(x_mm, y_mm); }
};

template <class Table>
std::vector<Deviation> deviations(const CopEstimator& estimator, const Table& plate, const std::vector<Point>& positions, double load_n) {
  std::vector<Deviation> result;
  for (const Point& position : positions) {
    const auto estimate = estimator.estimate(sample_of(plate, position, load_n).deflection_mm);
    result.push_back({estimate.x_mm - position.x.value, estimate.y_mm - position.y.value});
  }
  return result;
}

/// Root mean square per axis; its `total` is that of the radial error.
Deviation rms(const std::vector<Deviation>& all) {
  Deviation squares;
  for (const auto& one : all) {
    squares.x_mm += one.x_mm * one.x_mm / static_cast<double>(all.size());
    squares.y_mm += one.y_mm * one.y_mm / static_cast<double>(all.size());
  }
  return {std::sqrt(squares.x_mm), std::sqrt(squares.y_mm)};
}

/// The points of the 33 x 33 grid in the central 200 mm, as the study counts them.
std::vector<Point> central_square() {
  auto points = test::sensor_square(33);
  std::erase_if(points,
                [](const Point& point) { return std::max(std::abs(point.x.value - 215.0), std::abs(point.y.value - 215.0)) > 100.0; });
  return points;
}

CopEstimator thesis_on_mid_lines(const RefinedPlate& plate) {
  return *CopEstimator::fit(CopMethod::Thesis, test::samples_at(plate, test::mid_lines(), kLoadN));
}

CopEstimator poly3_on_grid(const RefinedPlate& plate) {
  return *CopEstimator::fit(CopMethod::Poly3, test::samples_at(plate, test::sensor_square(7), kLoadN));
}

TEST(CopEstimatorThesis, Table41_MeetsTheStudyPointByPoint) {
  RecordProperty("requirement", "COP-3");
  const std::vector<Deviation> expected = {{3.29, 3.29},   {-0.10, 3.64}, {0.37, 0.37}, {-0.45, 3.00},  {-0.08, 0.46},
                                           {-0.15, -0.15}, {-0.16, 1.66}, {0.15, 0.30}, {-0.08, -0.11}, {-0.13, -0.13},
                                           {0.0, 0.0},     {0.29, 0.0},   {0.0, 0.0},   {-0.10, 0.0},   {0.0, 0.0}};
  const auto plate = floor_plate(10.75);

  const auto found = deviations(thesis_on_mid_lines(plate), plate, table_41_positions(), kLoadN);

  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_NEAR(found[k].x_mm, expected[k].x_mm, 0.03) << "P" << k + 1;
    EXPECT_NEAR(found[k].y_mm, expected[k].y_mm, 0.03) << "P" << k + 1;
  }
  EXPECT_NEAR(rms(found).x_mm, 0.87, 0.01);
  EXPECT_NEAR(rms(found).y_mm, 1.56, 0.01);
  const auto in_corners = floor_plate(0.0);
  const auto error = rms(deviations(thesis_on_mid_lines(in_corners), in_corners, table_41_positions(), kLoadN));
  EXPECT_NEAR(error.x_mm, 0.91, 0.01);
  EXPECT_NEAR(error.y_mm, 1.52, 0.01);
}

TEST(CopEstimatorThesis, Calibration_HasTheRatiosAndCoefficientsOfTheStudy) {
  const std::array<double, 5> expected_ratios = {1.73601, 1.30444, 1.0, 0.76661, 0.57603};
  const std::array<double, 5> coefficients = {619.758, -600.318, 232.277, -36.8414, 0.124436};
  const auto plate = floor_plate(10.75);
  const auto estimator = thesis_on_mid_lines(plate);

  for (std::size_t k = 0; k < expected_ratios.size(); ++k) {
    const auto w = sample_of(plate, at(86.0 + 64.5 * static_cast<double>(k), 215), 1.0).deflection_mm;
    const double ratio = (w[0] + w[2]) / (w[1] + w[3]);
    EXPECT_NEAR(ratio, expected_ratios[k], 5e-5 * ratio) << "the study's own accuracy is 0.005 %";
  }
  for (double ratio = 0.58; ratio < 1.73; ratio += 0.05) {
    double expected_mm = 0.0;
    for (std::size_t k = coefficients.size(); k-- > 0;) expected_mm = expected_mm * ratio + coefficients[k];
    const auto estimate = test::estimate(estimator, {ratio, 1.0, ratio, 1.0});
    EXPECT_NEAR(estimate.x_mm, expected_mm, 0.02) << ratio;
    EXPECT_NEAR(estimate.y_mm, 215.0, 1e-6) << ratio;
  }
}

TEST(CopEstimatorThesis, LoadBeyondTheCalibration_IsClampedAndSaysSo) {
  const auto estimator = *CopEstimator::from_model(CopMethod::Thesis, floor_rig(10.75));

  const auto left = test::estimate(estimator, {3.0, 1.0, 3.0, 1.0});
  const auto only_left = test::estimate(estimator, {3.0, 0.0, 3.0, -0.01});
  const auto right = test::estimate(estimator, {0.0, 3.0, -0.01, 3.0});

  EXPECT_NEAR(left.x_mm, 86.0, 3.0);
  EXPECT_EQ(only_left.x_mm, left.x_mm);
  EXPECT_NEAR(right.x_mm, 344.0, 3.0);
  EXPECT_FALSE(left.is_inside_calibration());
  EXPECT_FALSE(only_left.is_inside_calibration());
  EXPECT_FALSE(right.is_inside_calibration());
}

TEST(CopEstimatorPoly3, SensorSquare_IsWithinTheSheetsError) {
  const auto plate = floor_plate(10.75);
  const auto estimator = poly3_on_grid(plate);

  const auto square = rms(deviations(estimator, plate, test::sensor_square(33), kLoadN));
  const auto central = rms(deviations(estimator, plate, central_square(), kLoadN));

  EXPECT_NEAR(square.total(), 0.18, 0.01);
  EXPECT_NEAR(central.total(), 0.12, 0.01);
}

TEST(CopEstimatorPoly3, UnequalSensorGains_AreCalibratedAway) {
  const std::array<double, kFloorSensors> gains = {0.985, 1.02, 1.0, 1.01};
  const auto plate = meshed_plate(10.75);
  const auto scaled = [&](const Point& position) {
    CopSample sample = sample_of(plate, position, kLoadN);
    for (std::size_t k = 0; k < gains.size(); ++k) sample.deflection_mm[k] *= gains[k];
    return sample;
  };
  std::vector<CopSample> samples;
  for (const Point& position : test::sensor_square(7)) samples.push_back(scaled(position));

  const auto estimator = CopEstimator::fit(CopMethod::Poly3, samples);

  ASSERT_TRUE(estimator);
  std::vector<Deviation> found;
  for (const Point& position : test::sensor_square(33)) {
    const auto estimate = estimator->estimate(scaled(position).deflection_mm);
    found.push_back({estimate.x_mm - position.x.value, estimate.y_mm - position.y.value});
  }
  EXPECT_LT(rms(found).total(), 0.26);
}

/// One estimator for each method of four sensors, calibrated on the linear plate.
const std::vector<CopEstimator>& floor_estimators() {
  static const std::vector<CopEstimator> kEstimators = [] {
    std::vector<CopEstimator> all;
    for (const auto method : {CopMethod::Thesis, CopMethod::ThesisPerPair, CopMethod::Poly3}) {
      all.push_back(CopEstimator::from_model(method, floor_rig(10.75), PlateBehaviour::Linear).value());
      EXPECT_EQ(all.back().method(), method);
    }
    return all;
  }();
  return kEstimators;
}

TEST(CopEstimatorFloor, LinearPlate_LoadChangesOnlyTheLoad) {
  const auto plate = meshed_plate(10.75);
  for (const CopEstimator& estimator : floor_estimators()) {
    const auto light = estimator.estimate(sample_of(plate, at(130, 260), 400.0).deflection_mm);
    const auto heavy = estimator.estimate(sample_of(plate, at(130, 260), 580.0).deflection_mm);

    // Poly3 has learned from two loads that the sum says nothing here, but for the small error of its polynomial.
    const bool is_poly3 = estimator.method() == CopMethod::Poly3;
    EXPECT_NEAR(light.x_mm, heavy.x_mm, is_poly3 ? 0.05 : 1e-9);
    EXPECT_NEAR(light.y_mm, heavy.y_mm, is_poly3 ? 0.05 : 1e-9);
    EXPECT_NEAR(heavy.load_n / light.load_n, 1.45, is_poly3 ? 1e-3 : 1e-9);
  }
}

TEST(CopEstimatorFloor, DeflectionsOfNoForce_AreNoContact) {
  constexpr double kHugeMm = 1e308 / 8.0;  // the sum is finite, the load is not
  std::vector<std::vector<double>> all = {{},           {1, 1, 1},        {1, 1, 1, 1, 1}, {kHugeMm, kHugeMm, kHugeMm, kHugeMm},
                                          {0, 0, 0, 0}, {-1, -1, -1, -1}, {1, -1, 1, -1},  {0, 0, 0, -1e-12}};
  for (const double bad : {kNaN, kInfinity, -kInfinity}) {
    for (std::size_t k = 0; k < kFloorSensors; ++k) {
      all.emplace_back(kFloorSensors, 1.0);
      all.back()[k] = bad;
    }
  }
  for (const CopEstimator& estimator : floor_estimators()) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      const auto estimate = estimator.estimate(all[k]);
      EXPECT_TRUE(std::isnan(estimate.x_mm) && std::isnan(estimate.y_mm) && std::isnan(estimate.load_n)) << k;
      EXPECT_EQ(estimate.flags, cop_flag::kNoContact) << k;
    }
  }
}

TEST(CopEstimatorFloor, BeyondTheCalibration_IsFlaggedAndClampedToTheArea) {
  RecordProperty("requirement", "COP-8");
  const auto plate = meshed_plate(10.75);
  for (const CopEstimator& estimator : floor_estimators()) {
    const auto& [x_mm, y_mm, load_n] = estimator.validity();
    for (const double wrong_n : {0.5 * load_n.lowest, 1.2 * load_n.highest}) {
      EXPECT_EQ(estimator.estimate(sample_of(plate, at(215, 200), wrong_n).deflection_mm).flags, cop_flag::kOutsideLoad);
    }
    for (const Point& position : {at(20, 215), at(215, 20), at(410, 215), at(215, 410), at(20, 20), at(410, 410), at(40, 390)}) {
      const auto estimate = estimator.estimate(sample_of(plate, position, kLoadN).deflection_mm);
      EXPECT_NE(estimate.flags & cop_flag::kOutsideArea, 0) << position.x.value << ", " << position.y.value;
      EXPECT_TRUE(x_mm.contains(estimate.x_mm) && y_mm.contains(estimate.y_mm));
    }
  }
}

TEST(CopEstimatorFloor, SensorSquare_IsInsideTheCalibrationAndTheLoadWithinHalfAPercent) {
  const auto plate = meshed_plate(10.75);
  const auto positions = test::sensor_square(33);
  for (const CopEstimator& estimator : floor_estimators()) {
    double squares = 0.0;
    for (const Point& position : positions) {
      const auto estimate = estimator.estimate(sample_of(plate, position, 560.0).deflection_mm);
      EXPECT_EQ(estimate.flags, 0) << position.x.value << ", " << position.y.value;
      EXPECT_NEAR(estimate.load_n, 560.0, 0.005 * 560.0) << position.x.value << ", " << position.y.value;
      squares += std::pow(estimate.load_n / 560.0 - 1.0, 2);
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(positions.size())), 0.002);
  }
}

TEST(CopEstimatorFloor, AnyFiniteInput_GivesAPositionNearThePlateOrNone) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> mantissa(-1.0, 1.0);
  std::uniform_int_distribution<int> exponent(-1070, 1024);
  for (int round = 0; round < 20'000; ++round) {
    std::array<double, kFloorSensors> deflection{};
    for (double& value : deflection) value = round % 2 == 0 ? std::ldexp(mantissa(random), exponent(random)) : mantissa(random);
    for (const CopEstimator& estimator : floor_estimators()) {
      const auto estimate = estimator.estimate(deflection);

      if (std::isnan(estimate.x_mm)) continue;
      EXPECT_TRUE(estimate.x_mm > 0.0 && estimate.x_mm < 430.0 && estimate.y_mm > 0.0 && estimate.y_mm < 430.0);
      EXPECT_GE(estimate.load_n, 0.0);
    }
  }
}

TEST(CopEstimatorAnySensors, AnyFiniteInput_GivesAPositionInTheAreaOrAFlag) {
  auto nine = floor_rig(10.75);
  for (int k = 0; k < 5; ++k)
    nine.sensors.push_back({"m" + std::to_string(k), at(100.0 + 50.0 * k, 215.0 - 20.0 * k), SensorCurve::hoa1405_assumed()});
  std::mt19937 random(7);
  std::uniform_real_distribution<double> mantissa(-1.0, 1.0);
  std::uniform_int_distribution<int> exponent(-1070, 1024);
  for (const auto method : {CopMethod::Moment, CopMethod::Model}) {
    const auto estimator = *CopEstimator::from_model(method, nine, PlateBehaviour::Linear);
    for (int round = 0; round < 1000; ++round) {
      std::vector<double> deflection(9);
      for (double& value : deflection) value = round % 2 == 0 ? std::ldexp(mantissa(random), exponent(random)) : mantissa(random);

      const auto estimate = estimator.estimate(deflection);

      if (std::isnan(estimate.x_mm) || std::isnan(estimate.y_mm)) {
        EXPECT_NE(estimate.flags, 0);
      } else {
        EXPECT_TRUE(estimator.validity().x_mm.contains(estimate.x_mm) && estimator.validity().y_mm.contains(estimate.y_mm));
      }
      EXPECT_TRUE(estimate.load_n >= 0.0 || estimate.flags != 0);
    }
  }
}

}  // namespace
}  // namespace dts::physics
