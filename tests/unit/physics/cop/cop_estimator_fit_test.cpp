// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/special_numbers.h"
#include "physics/cop/cop_estimator.h"
#include "unit/physics/floor_platform.h"

namespace dts::physics {
namespace {

using test::at;
using testing::HasSubstr;

constexpr double kFitLoadN = 490.0;

/// A synthetic plate that stiffens with its own deflection: heavier loads bend it less than in proportion and, because the
/// sensors that move most lose most, in another shape. Not a model of the real plate's membrane forces (plate-model 5.2).
class SyntheticPlate {
 public:
  [[nodiscard]] CopSample sample(Point position, double load_n) const {
    constexpr double kStiffeningPerSquareMm = 0.001;
    CopSample sample = test::sample_of(table_, position, load_n);
    for (double& w : sample.deflection_mm) w /= 1.0 + kStiffeningPerSquareMm * w * w;
    return sample;
  }

  [[nodiscard]] std::vector<CopSample> grid(int count, std::initializer_list<double> loads_n) const {
    std::vector<CopSample> samples;
    for (const double load_n : loads_n) {
      for (const Point& position : test::sensor_square(count)) samples.push_back(sample(position, load_n));
    }
    return samples;
  }

  /// Root mean square radial error over the sensor square, mm.
  [[nodiscard]] double error_mm(const CopEstimator& estimator, double load_n) const {
    double squares = 0.0;
    const auto positions = test::sensor_square(21);
    for (const Point& position : positions) {
      const auto estimate = estimator.estimate(sample(position, load_n).deflection_mm);
      squares += std::pow(estimate.x_mm - position.x.value, 2) + std::pow(estimate.y_mm - position.y.value, 2);
    }
    return std::sqrt(squares / static_cast<double>(positions.size()));
  }

 private:
  InfluenceTable table_ = *InfluenceTable::create(test::steel_plate(), test::corners(10.75), test::floor_sensors());
};

std::vector<CopSample> linear_samples(const std::vector<Point>& positions, double load_n = kFitLoadN) {
  const auto plate = *InfluenceTable::create(test::steel_plate(), test::corners(10.75), test::floor_sensors());
  return test::samples_at(plate, positions, load_n);
}

void expect_refused(CopMethod method, const std::vector<CopSample>& samples, const char* why) {
  const auto result = CopEstimator::fit(method, samples);

  ASSERT_FALSE(result) << why;
  EXPECT_EQ(result.error().code, core::ErrorCode::InvalidArgument);
  EXPECT_THAT(core::to_string(result.error()), HasSubstr(why));
}

TEST(CopEstimatorFit, TwoLoads_LearnTheStiffeningThatOneLoadMisses) {
  const SyntheticPlate plate;
  const auto one_load = CopEstimator::fit(CopMethod::Poly3, plate.grid(7, {540.0}));
  const auto two_loads = CopEstimator::fit(CopMethod::Poly3, plate.grid(7, {360.0, 720.0}));
  const auto near_loads = CopEstimator::fit(CopMethod::Poly3, plate.grid(7, {400.0, 700.0}));

  ASSERT_TRUE(one_load && two_loads && near_loads);
  EXPECT_LT(plate.error_mm(*one_load, 540.0), 0.2);
  for (const double load_n : {360.0, 450.0, 630.0, 720.0}) EXPECT_GT(plate.error_mm(*one_load, load_n), 0.6) << load_n;
  for (const double load_n : {360.0, 450.0, 540.0, 630.0, 720.0}) EXPECT_LT(plate.error_mm(*two_loads, load_n), 0.35) << load_n;
  for (const double load_n : {400.0, 550.0, 700.0}) EXPECT_LT(plate.error_mm(*near_loads, load_n), 0.35) << load_n;
  for (const Point& position : test::sensor_square(9)) {
    EXPECT_NEAR(two_loads->estimate(plate.sample(position, 500.0).deflection_mm).load_n, 500.0, 5.0);
  }
}

TEST(CopEstimatorFit, EachLoadWithAGrid_GivesAPowerOfTheSum) {
  const SyntheticPlate plate;
  struct Case {
    std::initializer_list<double> loads_n;
    std::size_t power_count;
  };
  for (const auto& [loads_n, power_count] :
       {Case{{480.0, 500.0}, 1}, Case{{360.0, 720.0}, 2}, Case{{240.0, 450.0, 720.0}, 3}, Case{{240.0, 350.0, 500.0, 720.0}, 3}}) {
    const auto estimator = CopEstimator::fit(CopMethod::Poly3, plate.grid(7, loads_n));
    ASSERT_TRUE(estimator);
    EXPECT_EQ(std::get<Poly3Form>(estimator->form()).polynomial.sum_power_count, power_count);
    if (power_count == 3) {
      EXPECT_LT(plate.error_mm(*estimator, 600.0), 0.2);
    }
  }
  auto samples = plate.grid(7, {240.0, 720.0});
  const auto middle = plate.grid(3, {450.0});
  samples.insert(samples.end(), middle.begin(), middle.end());
  const auto estimator = CopEstimator::fit(CopMethod::Poly3, samples);
  ASSERT_TRUE(estimator);
  EXPECT_EQ(std::get<Poly3Form>(estimator->form()).polynomial.sum_power_count, 2U) << "nine positions of the middle load do not count";
}

TEST(CopEstimatorFit, LightLoad_IsALoad) { EXPECT_TRUE(CopEstimator::fit(CopMethod::Poly3, linear_samples(test::sensor_square(7), 0.5))); }

TEST(CopEstimatorFit, LoadRange_ReachesAFifthBeyondTheCalibrationLoads) {
  const SyntheticPlate plate;
  const auto one_load = CopEstimator::fit(CopMethod::Poly3, plate.grid(7, {500.0}));
  const auto two_loads = CopEstimator::fit(CopMethod::Poly3, plate.grid(7, {360.0, 720.0}));

  ASSERT_TRUE(one_load && two_loads);
  EXPECT_DOUBLE_EQ(one_load->validity().load_n.lowest, 400.0);
  EXPECT_DOUBLE_EQ(one_load->validity().load_n.highest, 600.0);
  EXPECT_DOUBLE_EQ(two_loads->validity().load_n.lowest, 288.0);
  EXPECT_DOUBLE_EQ(two_loads->validity().load_n.highest, 864.0);
  EXPECT_EQ(one_load->estimate(plate.sample(at(200, 200), 300.0).deflection_mm).flags, cop_flag::kOutsideLoad);
  EXPECT_EQ(one_load->estimate(plate.sample(at(200, 200), 550.0).deflection_mm).flags, 0);
}

TEST(CopEstimatorFit, SmallGrid_FallsBackToDegreeThree) {
  const SyntheticPlate plate;
  for (const int count : {4, 5}) {
    const auto estimator = CopEstimator::fit(CopMethod::Poly3, linear_samples(test::sensor_square(count)));

    ASSERT_TRUE(estimator) << count;
    double worst_mm = 0.0;
    for (const auto& sample : linear_samples(test::sensor_square(33))) {
      const auto estimate = estimator->estimate(sample.deflection_mm);
      worst_mm = std::max(worst_mm, std::hypot(estimate.x_mm - sample.load_position.x.value, estimate.y_mm - sample.load_position.y.value));
    }
    // Degree 3 is good to 0.9 mm rms; an under-determined quintic would be off by 1.8 mm rms (plate-model 5.2).
    EXPECT_LT(worst_mm, 3.0) << count;
  }
}

TEST(CopEstimatorFit, RepeatedMeasurements_AreAveraged) {
  auto samples = linear_samples(test::sensor_square(7));
  const auto once = CopEstimator::fit(CopMethod::Poly3, samples);
  const auto again = samples;
  samples.insert(samples.end(), again.begin(), again.end());

  const auto twice = CopEstimator::fit(CopMethod::Poly3, samples);

  ASSERT_TRUE(once && twice);
  EXPECT_NEAR(test::estimate(*twice, {1.0, 1.2, 0.9, 1.1}).x_mm, test::estimate(*once, {1.0, 1.2, 0.9, 1.1}).x_mm, 1e-8);
}

TEST(CopEstimatorFit, ThesisWithMidLinesOnly_EstimatesTheLoadOnThem) {
  const auto samples = linear_samples(test::mid_lines());
  const auto estimator = CopEstimator::fit(CopMethod::Thesis, samples);

  ASSERT_TRUE(estimator);
  for (const auto& sample : samples) {
    const auto estimate = estimator->estimate(sample.deflection_mm);
    EXPECT_NEAR(estimate.load_n, kFitLoadN, 1e-6);
    EXPECT_NEAR(estimate.x_mm, sample.load_position.x.value, 1e-8);
    EXPECT_NEAR(estimate.y_mm, sample.load_position.y.value, 1e-8);
  }
}

TEST(CopEstimatorFit, ThesisWithSevenPointsPerLine_IsALeastSquaresQuartic) {
  std::vector<Point> positions;
  for (int k = 0; k < 7; ++k) {
    positions.push_back(at(86.0 + 43.0 * k, 215));
    positions.push_back(at(215, 86.0 + 43.0 * k));
  }
  const auto samples = linear_samples(positions);

  const auto estimator = CopEstimator::fit(CopMethod::Thesis, samples);

  ASSERT_TRUE(estimator);
  for (const auto& sample : samples) EXPECT_NEAR(estimator->estimate(sample.deflection_mm).x_mm, sample.load_position.x.value, 0.3);
}

TEST(CopEstimatorFit, ThesisWithTwoLoads_LearnsWhatTheStiffeningDoesToTheLoad) {
  const SyntheticPlate plate;
  const auto one_load = CopEstimator::fit(CopMethod::Thesis, plate.grid(7, {540.0}));
  const auto two_loads = CopEstimator::fit(CopMethod::Thesis, plate.grid(7, {360.0, 720.0}));

  ASSERT_TRUE(one_load && two_loads);
  const auto w = plate.sample(at(180, 250), 400.0).deflection_mm;
  EXPECT_GT(std::abs(one_load->estimate(w).load_n - 400.0), 2.0);
  EXPECT_NEAR(two_loads->estimate(w).load_n, 400.0, 1.0);
}

TEST(CopEstimatorFit, PositionsThatDetermineNothing_AreRefusedWithTheirNumber) {
  const auto refused = [](const std::vector<Point>& positions, const char* why) {
    expect_refused(CopMethod::Poly3, linear_samples(positions), why);
  };
  refused({}, "no samples");
  refused({at(215, 215)}, "1 positions in 1 columns and 1 rows");
  refused(test::sensor_square(3), "9 positions in 3 columns and 3 rows");
  refused(std::vector<Point>(60, at(200, 200)), "1 positions");
  std::vector<Point> diagonal;
  for (int k = 0; k < 40; ++k) diagonal.push_back(at(100.0 + 5.0 * k, 100.0 + 5.0 * k));
  refused(diagonal, "coefficients");
  // Not exactly singular, as the features lie near a circle only: noise would decide the coefficients.
  std::vector<Point> circle;
  for (int k = 0; k < 60; ++k) circle.push_back(at(215.0 + 100.0 * std::cos(0.1047 * k), 215.0 + 100.0 * std::sin(0.1047 * k)));
  refused(circle, "60 samples determine only");

  const SyntheticPlate plate;
  auto samples = plate.grid(7, {360.0});
  const auto heavy = plate.grid(3, {720.0});
  samples.insert(samples.end(), heavy.begin(), heavy.end());
  expect_refused(CopMethod::Poly3, samples, "9 positions in 3 columns and 3 rows are too few for poly3 at each of the loads");
  auto no_middle = test::mid_lines();
  std::erase(no_middle, at(215, 150.5));
  expect_refused(CopMethod::Thesis, linear_samples(no_middle), "mid-line along y has 4 positions");
  expect_refused(CopMethod::Thesis, linear_samples(test::sensor_square(4)), "mid-line along x has 0 positions");
  expect_refused(CopMethod::Poly3, std::vector<CopSample>(10'001), "10001 samples, at most 10000");
  expect_refused(CopMethod::Model, linear_samples(test::sensor_square(7)), "model has no coefficients to fit");
}

TEST(CopEstimatorFit, SwappedSensors_AreRefusedWithAHint) {
  RecordProperty("requirement", "COP-9");
  for (const auto method : {CopMethod::Thesis, CopMethod::ThesisPerPair, CopMethod::Poly3}) {
    auto samples = linear_samples(method == CopMethod::Poly3 ? test::sensor_square(7) : test::mid_lines());
    for (auto& sample : samples) std::swap(sample.deflection_mm[0], sample.deflection_mm[1]);

    expect_refused(method, samples, "sensors are in the order w1 left back");
  }
}

TEST(CopEstimatorFit, WrongNumberOfSensors_IsRefusedByMethod) {
  auto samples = linear_samples(test::sensor_square(7));
  expect_refused(CopMethod::Moment, samples, "moment needs 5 to 32 sensors, the samples have 4");
  for (auto& sample : samples) sample.deflection_mm.push_back(1.0);
  expect_refused(CopMethod::Poly3, samples, "poly3 needs 4 sensors, the samples have 5");
  samples[2].deflection_mm.pop_back();
  expect_refused(CopMethod::Moment, samples, "sample 2 has 4 deflections, the first one 5");
}

TEST(CopEstimatorFit, BadSample_IsRefusedWithItsNumber) {
  const auto good = linear_samples(test::sensor_square(7));
  const auto spoilt = [&](auto spoil) {
    auto samples = good;
    spoil(samples[3]);
    return samples;
  };

  for (const auto method : {CopMethod::Thesis, CopMethod::Poly3}) {
    expect_refused(method, spoilt([](CopSample& sample) { sample.deflection_mm[2] = core::kNaN; }), "sample 3");
    expect_refused(method, spoilt([](CopSample& sample) { sample.load_position.x = {INFINITY}; }), "sample 3");
    expect_refused(method, spoilt([](CopSample& sample) { sample.load = {core::kNaN}; }), "sample 3");
    expect_refused(method, spoilt([](CopSample& sample) { sample.load = {0.0}; }), "load of sample 3 is 0");
    expect_refused(method, spoilt([](CopSample& sample) { sample.load = {-490.0}; }), "load of sample 3 is -490");
    expect_refused(method, spoilt([](CopSample& sample) { sample.deflection_mm = {0, 0, 0, 0}; }), "sample 3 does not press");
    expect_refused(method, spoilt([](CopSample& sample) { sample.deflection_mm = {1, -2, 1, -2}; }), "sample 3 does not press");
  }
}

TEST(CopEstimatorFit, MirroredOrSwappedPositions_AreRefusedByPoly3Too) {
  RecordProperty("requirement", "COP-9");
  for (const bool is_mirrored : {true, false}) {
    auto samples = linear_samples(test::sensor_square(7));
    for (CopSample& sample : samples) {
      const Point right = sample.load_position;
      sample.load_position = is_mirrored ? at(430.0 - right.x.value, right.y.value) : at(right.y.value, right.x.value);
    }
    expect_refused(CopMethod::Poly3, samples, "do not bend towards the load along x");
  }
}

}  // namespace
}  // namespace dts::physics
