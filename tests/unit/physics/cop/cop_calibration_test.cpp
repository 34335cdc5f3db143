// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/cop_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "physics/cop/cop_evaluation.h"
#include "physics/cop/cop_fit.h"
#include "unit/physics/floor_platform.h"

namespace dts::physics {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const CopCalibrationOrigin kOrigin{.created_utc = "2026-01-31T12:00:00Z", .rig = "floor", .daq_model = "USB-6008", .daq_serial = "0123"};

std::vector<CopSample> samples_of(CopMethod method) {
  return model_samples(method, test::floor_rig(10.75), PlateBehaviour::Stiffening).value();
}

const CopCalibration& poly3() {
  static const CopCalibration kCalibration = calibrate_cop(CopMethod::Poly3, samples_of(CopMethod::Poly3), kOrigin).value();
  return kCalibration;
}

TEST(CopCalibration, Id_SaysDateSamplesAndMethod) {
  auto samples = samples_of(CopMethod::Poly3);
  const auto first = calibrate_cop(CopMethod::Poly3, samples, kOrigin).value();
  const auto again = calibrate_cop(CopMethod::Poly3, samples, kOrigin).value();
  samples[0].deflection_mm[0] += 1e-6;
  const auto other = calibrate_cop(CopMethod::Poly3, samples, kOrigin).value();

  EXPECT_THAT(first.id, StartsWith("cop-20260131T120000Z-"));
  EXPECT_EQ(first.id.size(), std::string("cop-20260131T120000Z-1a2b3c4d").size());
  EXPECT_EQ(again.id, first.id);
  EXPECT_NE(other.id, first.id);
  const auto mid_lines = samples_of(CopMethod::Thesis);
  EXPECT_NE(calibrate_cop(CopMethod::Thesis, mid_lines, kOrigin).value().id,
            calibrate_cop(CopMethod::ThesisPerPair, mid_lines, kOrigin).value().id);
}

TEST(CopCalibration, BadDate_IsRefused) {
  const auto samples = samples_of(CopMethod::Poly3);
  for (const char* date : {"", "today", "2026-01-31 12:00:00Z", "2026-01-31T12:00:00", "2026-01-31T12:00:00Zx"}) {
    const auto result = calibrate_cop(CopMethod::Poly3, samples, {.created_utc = date});
    ASSERT_FALSE(result) << date;
    EXPECT_THAT(result.error().what, HasSubstr("is not like 2026-01-31T12:00:00Z"));
  }
}

TEST(CopCalibration, Residuals_AreThoseOfThePoints) {
  const auto& calibration = poly3();

  ASSERT_EQ(calibration.points.size(), 3U * 49U);
  double squares = 0.0;
  double load_squares = 0.0;
  double largest = 0.0;
  for (const auto& point : calibration.points) {
    const auto estimate = calibration.estimator.estimate(point.sample.deflection_mm);
    EXPECT_EQ(point.x_error_mm, estimate.x_mm - point.sample.load_position.x.value);
    squares += std::pow(point.x_error_mm, 2) + std::pow(point.y_error_mm, 2);
    load_squares += std::pow(100.0 * (estimate.load_n / point.sample.load.value - 1.0), 2);
    largest = std::max(largest, std::hypot(point.x_error_mm, point.y_error_mm));
  }
  EXPECT_NEAR(calibration.residuals.rms_total_mm, std::sqrt(squares / 147.0), 1e-12);
  EXPECT_EQ(calibration.residuals.max_total_mm, largest);
  EXPECT_NEAR(calibration.residuals.load_rms_percent, std::sqrt(load_squares / 147.0), 1e-12);
}

TEST(CopCalibration, LoadError_IsThatOfPositionsLeftOutWhereThereAreSome) {
  const auto& calibration = poly3();
  ASSERT_TRUE(calibration.cross_validated);
  EXPECT_GT(calibration.cross_validated->rms_total_mm, calibration.residuals.rms_total_mm);
  EXPECT_LT(calibration.cross_validated->rms_total_mm, 3.0 * calibration.residuals.rms_total_mm);
  EXPECT_EQ(calibration.load_error_percent(), calibration.cross_validated->load_rms_percent);
  const auto rig = test::floor_rig(10.75);
  const auto trials = point_trials(grid_positions(SensorRectangle::of(rig), 6), std::array{300.0, 400.0, 600.0, 700.0});
  const auto found = evaluate_cop(rig, calibration.estimator, trials).value();
  EXPECT_LT(found.figures.load_rms_percent, 1.5 * calibration.load_error_percent());

  const auto interpolated = calibrate_cop(CopMethod::Thesis, samples_of(CopMethod::Thesis), kOrigin).value();
  EXPECT_FALSE(interpolated.cross_validated);
  EXPECT_EQ(interpolated.load_error_percent(), interpolated.residuals.load_rms_percent);
}

TEST(CopCalibration, SensorsOfAModelInAnotherOrder_AreRefused) {
  RecordProperty("requirement", "COP-9");
  auto rig = test::floor_rig(0.0);
  std::swap(rig.sensors[1], rig.sensors[3]);
  const auto samples = model_samples(CopMethod::Poly3, rig, PlateBehaviour::Linear);
  ASSERT_FALSE(samples);
  EXPECT_EQ(samples.error().what, "sensor 2 ('w4') at (344.000000, 344.000000) mm is not right back of the sensors' centre");
}

TEST(CopCalibration, LeftOutEstimates_AreThoseOfFitsWithoutThePoint) {
  for (const auto method : {CopMethod::Poly3, CopMethod::Moment}) {
    auto rig = test::floor_rig(10.75);
    if (method == CopMethod::Moment) {
      for (int k = 0; k < 5; ++k)
        rig.sensors.push_back({"m" + std::to_string(k), test::at(100.0 + 50.0 * k, 215.0 - 20.0 * k), SensorCurve::hoa1405_assumed()});
    }
    const auto samples = model_samples(method, rig, PlateBehaviour::Stiffening).value();
    const auto fitted = fit_cop(method, samples).value();
    const std::size_t middle = method == CopMethod::Moment ? 81 + 40 : 49 + 24;  // of the area, so that no range changes without it
    std::vector<CopSample> without = samples;
    without.erase(without.begin() + middle);

    const auto estimate = CopEstimator::fit(method, without).value().estimate(samples[middle].deflection_mm);

    ASSERT_EQ(fitted.left_out.size(), samples.size());
    // The ridge of Moment loses the point's own part of noise: one of hundreds.
    const double tolerance_mm = method == CopMethod::Moment ? 1e-3 : 1e-6;
    EXPECT_NEAR(fitted.left_out[middle].x_mm, estimate.x_mm, tolerance_mm);
    EXPECT_NEAR(fitted.left_out[middle].y_mm, estimate.y_mm, tolerance_mm);
    EXPECT_NEAR(fitted.left_out[middle].load_n / estimate.load_n, 1.0, 1e-5);
  }
}

TEST(CopForm, NonsenseCoefficients_AreRefused) {
  const auto& good = poly3().estimator;
  const auto refused = [&](auto spoil) {
    auto form = std::get<Poly3Form>(good.form());
    CopValidity validity = good.validity();
    spoil(form.polynomial, validity);
    return !CopEstimator::from_form(CopMethod::Poly3, form, validity);
  };

  EXPECT_TRUE(CopEstimator::from_form(CopMethod::Poly3, good.form(), good.validity()));
  EXPECT_FALSE(CopEstimator::from_form(CopMethod::Thesis, good.form(), good.validity()));
  EXPECT_TRUE(refused([](SumPolynomial& p, CopValidity&) { p.by_sum_power[1].coefficients[7][0] = NAN; }));
  EXPECT_TRUE(refused([](SumPolynomial& p, CopValidity&) { p.reference_sum_mm = 0.0; }));
  EXPECT_TRUE(refused([](SumPolynomial& p, CopValidity&) { p.sum_power_count = 4; }));
  EXPECT_TRUE(refused([](SumPolynomial& p, CopValidity&) { p.u = {1.0, -1.0}; }));
  EXPECT_TRUE(refused([](SumPolynomial&, CopValidity& v) { v.x_mm = {0.0, INFINITY}; }));
  EXPECT_TRUE(refused([](SumPolynomial&, CopValidity& v) { v.load_n = {-1.0, 5.0}; }));
}

TEST(CopForm, PositionThatOverflowsAlongOneAxis_IsNoContact) {
  const auto& good = poly3().estimator;
  for (const std::size_t output : {std::size_t{0}, std::size_t{1}}) {
    auto form = std::get<Poly3Form>(good.form());
    for (auto& row : form.polynomial.by_sum_power[0].coefficients) row[output] = 1.7e308;
    const auto estimator = CopEstimator::from_form(CopMethod::Poly3, form, good.validity()).value();

    const auto estimate = estimator.estimate(poly3().points[48].sample.deflection_mm);

    EXPECT_EQ(estimate.flags, cop_flag::kNoContact) << output;
    EXPECT_TRUE(std::isnan(estimate.x_mm) && std::isnan(estimate.y_mm) && std::isnan(estimate.load_n)) << output;
  }
}

}  // namespace
}  // namespace dts::physics
