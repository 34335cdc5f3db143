// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/cop_evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "unit/physics/floor_platform.h"

namespace dts::physics {
namespace {

using testing::HasSubstr;

constexpr std::array<double, 2> kLoadsN{300.0, 600.0};

TEST(CopTrials, Table41_IsATriangularEighthOfTheSensorSquareLoadByLoad) {
  const auto positions = table_41_positions();

  ASSERT_EQ(positions.size(), 15U);
  EXPECT_EQ(positions.front(), test::at(86.0, 86.0));
  EXPECT_EQ(positions[1], test::at(86.0, 118.25));
  EXPECT_EQ(positions[8], test::at(150.5, 182.75));
  EXPECT_EQ(positions.back(), test::at(215.0, 215.0));

  const auto trials = point_trials(positions, kLoadsN);
  ASSERT_EQ(trials.size(), 30U);
  for (std::size_t k = 0; k < 30; ++k) {
    EXPECT_EQ(trials[k].loads[0].force.value, k < 15 ? 300.0 : 600.0);
    EXPECT_EQ(trials[k].centre, positions[k % 15]);
  }
}

TEST(CopTrials, FootTrials_HaveTheirCentreAndLoad) {
  for (const std::size_t feet : {std::size_t{1}, std::size_t{2}}) {
    const auto trials = foot_trials(test::steel_plate(), feet, 50, {400.0, 500.0}, 3);

    ASSERT_EQ(trials.size(), 50U);
    for (const CopTrial& trial : trials) {
      ASSERT_EQ(trial.loads.size(), 2 * feet);
      double sum_n = 0.0;
      double moment_x = 0.0;
      double moment_y = 0.0;
      for (const PlateLoad& load : trial.loads) {
        sum_n += load.force.value;
        moment_x += load.force.value * load.area.centre.x.value;
        moment_y += load.force.value * load.area.centre.y.value;
      }
      EXPECT_TRUE(sum_n >= 400.0 && sum_n <= 500.0);
      EXPECT_NEAR(trial.centre.x.value, moment_x / sum_n, 1e-9);
      EXPECT_NEAR(trial.centre.y.value, moment_y / sum_n, 1e-9);
    }
  }
  Plate small = test::steel_plate();
  small.a = {150.0};
  EXPECT_TRUE(foot_trials(small, 2, 20, {400.0, 500.0}, 3).empty()) << "two feet find no room";
}

TEST(SensedPlate, Stiffening_BendsLessThanTheLinearPlateAndAlikeUnderLittle) {
  const auto rig = test::floor_rig(10.75);
  const auto linear = SensedPlate::create(rig, PlateBehaviour::Linear).value();
  const auto stiffening = SensedPlate::create(rig, PlateBehaviour::Stiffening).value();

  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(stiffening.deflection_mm(test::at(215, 215), {5.0})[k] / linear.deflection_mm(test::at(215, 215), {5.0})[k], 1.0, 1e-3);
    EXPECT_LT(stiffening.deflection_mm(test::at(215, 215), {686.0})[k], 0.95 * linear.deflection_mm(test::at(215, 215), {686.0})[k]);
  }
}

TEST(SensedPlate, HeavyLoads_BendThePlateSteadily) {
  // A solver that starts too far from the solution finds another one at some loads: the curve over the load would jump.
  const auto plate = SensedPlate::create(test::floor_rig(10.75), PlateBehaviour::Stiffening).value();
  for (const Point& position : {test::at(202.1, 150.5), test::at(176.3, 124.7)}) {
    for (double load_n = 700.0; load_n <= 1000.0; load_n += 10.0) {
      const auto before = plate.deflection_mm(position, {load_n - 5.0});
      const auto here = plate.deflection_mm(position, {load_n});
      const auto after = plate.deflection_mm(position, {load_n + 5.0});
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(before[k] + after[k], 2.0 * here[k], 0.01) << load_n;
    }
  }
}

TEST(SensedPlate, BadPlate_IsRefusedEitherWay) {
  auto rig = test::floor_rig(10.75);
  rig.plate.nu = 0.7;

  EXPECT_FALSE(SensedPlate::create(rig, PlateBehaviour::Linear));
  EXPECT_FALSE(SensedPlate::create(rig, PlateBehaviour::Stiffening));
}

class CopEvaluationTest : public testing::Test {
 protected:
  RigModel rig_ = test::floor_rig(10.75);
  CopEstimator estimator_ = CopEstimator::from_model(CopMethod::Poly3, rig_, PlateBehaviour::Linear).value();
  std::vector<CopTrial> trials_ = point_trials(table_41_positions(), kLoadsN);
};

TEST_F(CopEvaluationTest, SameSeed_GivesTheSameNoise) {
  EXPECT_EQ(parse_cop_noise("none"), CopNoise::None);
  EXPECT_EQ(parse_cop_noise("realistic"), CopNoise::Realistic);
  EXPECT_FALSE(parse_cop_noise("loud"));
  const CopEvaluationOptions options{.noise = CopNoise::Realistic, .seed = 7};

  const auto first = evaluate_cop(rig_, estimator_, trials_, options).value();
  const auto again = evaluate_cop(rig_, estimator_, trials_, options).value();
  const auto other = evaluate_cop(rig_, estimator_, trials_, {.noise = CopNoise::Realistic, .seed = 8}).value();

  EXPECT_EQ(first.figures.rms_total_mm, again.figures.rms_total_mm);
  EXPECT_NE(first.figures.rms_total_mm, other.figures.rms_total_mm);
}

TEST_F(CopEvaluationTest, Noise_IsThatOfTheSensors) {
  // 3 mV and steps of 4.88 mV, mean of three, at 0.35..0.9 V/mm: 2 to 6 um per sensor.
  const auto exact = evaluate_cop(rig_, estimator_, trials_).value();
  const auto noisy = evaluate_cop(rig_, estimator_, trials_, {.noise = CopNoise::Realistic}).value();

  double squares = 0.0;
  for (std::size_t k = 0; k < trials_.size(); ++k) {
    for (std::size_t c = 0; c < 4; ++c) {
      squares += std::pow(noisy.trials[k].point.sample.deflection_mm[c] - exact.trials[k].point.sample.deflection_mm[c], 2);
    }
  }
  const double noise_mm = std::sqrt(squares / static_cast<double>(4 * trials_.size()));
  EXPECT_GT(noise_mm, 0.002);
  EXPECT_LT(noise_mm, 0.006);
}

TEST_F(CopEvaluationTest, LoadsBeyondTheCalibration_AreCounted) {
  const auto evaluation = evaluate_cop(rig_, estimator_, point_trials(table_41_positions(), std::array{100.0})).value();

  EXPECT_EQ(evaluation.outside_count, 15U);
  EXPECT_EQ(evaluation.no_contact_count, 0U);
}

TEST_F(CopEvaluationTest, EstimatorOfAnotherRig_IsRefused) {
  rig_.sensors.pop_back();

  const auto result = evaluate_cop(rig_, estimator_, trials_);

  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().what, HasSubstr("the estimator is for 4 sensors, the rig has 3"));
}

}  // namespace
}  // namespace dts::physics
