// SPDX-License-Identifier: Apache-2.0
// The figures of plate-model section 5 and thesis Table 4.1, on the plate models that the estimators are calibrated on.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "physics/cop/cop_evaluation.h"
#include "unit/physics/floor_platform.h"

namespace dts::physics {
namespace {

using test::floor_rig;

constexpr std::array<double, 1> kThesisLoadN{490.0};  // thesis 4.5: 50 kgf

std::vector<CopTrial> table_41() { return point_trials(table_41_positions(), kThesisLoadN); }

/// From 240 to 700 N over the square between the sensors.
std::vector<CopTrial> square(const RigModel& rig) {
  constexpr std::array kLoadsN{240.0, 355.0, 470.0, 585.0, 700.0};
  return point_trials(grid_positions(SensorRectangle::of(rig), 10), kLoadsN);
}

CopErrorFigures errors(const RigModel& rig, const CopEstimator& estimator, const std::vector<CopTrial>& trials,
                       const CopEvaluationOptions& options) {
  const auto evaluation = evaluate_cop(rig, estimator, trials, options).value();
  EXPECT_EQ(evaluation.no_contact_count, 0U);
  return evaluation.figures;
}

/// Poly3 from two loads, as the sheet has it.
CopEstimator two_load_poly3(const RigModel& rig) {
  constexpr std::array<double, 2> kLoadsN{240.0, 700.0};
  const auto plate = SensedPlate::create(rig, PlateBehaviour::Stiffening).value();
  std::vector<CopSample> samples;
  for (const CopTrial& trial : point_trials(grid_positions(SensorRectangle::of(rig), 7), kLoadsN)) {
    samples.push_back({trial.centre, trial.loads[0].force, plate.deflection_mm(trial.loads)});
  }
  return CopEstimator::fit(CopMethod::Poly3, samples).value();
}

TEST(CopAcceptance, ThesisOnTheLinearPlate_IsAtLeastAsGoodAsTheThesis) {
  RecordProperty("requirement", "COP-3");
  for (const double inset_mm : {0.0, 10.75}) {
    const RigModel rig = floor_rig(inset_mm);
    const auto estimator = CopEstimator::from_model(CopMethod::Thesis, rig, PlateBehaviour::Linear).value();

    const auto evaluation = evaluate_cop(rig, estimator, table_41(), {.behaviour = PlateBehaviour::Linear}).value();

    EXPECT_LE(evaluation.figures.rms_x_mm, 1.39);
    EXPECT_LE(evaluation.figures.rms_y_mm, 1.63);
    EXPECT_LE(evaluation.figures.rms_total_mm, 2.15);
    for (std::size_t k = 10; k < 15; ++k) {
      const auto& point = evaluation.trials[k].point;
      EXPECT_LE(std::hypot(point.x_error_mm, point.y_error_mm), 0.35) << "mid-line point P" << k + 1;
    }
  }
}

TEST(CopAcceptance, ThesisOnTheStiffeningPlate_ErrsLikeTheRealSystemOfTheThesis) {
  const RigModel rig = floor_rig(10.75);
  const auto estimator = CopEstimator::from_model(CopMethod::Thesis, rig).value();

  const auto figures = errors(rig, estimator, table_41(), {});

  EXPECT_NEAR(figures.rms_total_mm, 3.0, 0.3);  // thesis Table 4.1, real system: 3.0
  EXPECT_LT(figures.load_rms_percent, 0.5);
}

TEST(CopAcceptance, ThesisPerPair_MeetsTheSheet) {
  // The sheet's figures belong to the plate without mesh error: 40 and 80 divisions extrapolated.
  const test::RefinedPlate plate(test::steel_plate(), test::corners(10.75), test::floor_sensors());
  auto samples = test::samples_at(plate, test::mid_lines(), 490.0);
  const auto beside = test::samples_at(plate, test::sensor_square(6), 490.0);
  samples.insert(samples.end(), beside.begin(), beside.end());
  const auto estimator = CopEstimator::fit(CopMethod::ThesisPerPair, samples).value();

  std::vector<CopCalibrationPoint> points;
  for (const auto& sample : test::samples_at(plate, table_41_positions(), 490.0)) {
    points.push_back(compare(sample, estimator.estimate(sample.deflection_mm)));
  }
  const auto figures = error_figures(points);

  EXPECT_NEAR(figures.rms_x_mm, 2.97, 0.01);
  EXPECT_NEAR(figures.rms_y_mm, 4.31, 0.01);
  EXPECT_NEAR(figures.rms_total_mm, 5.23, 0.01);
}

TEST(CopAcceptance, Poly3FromTwoLoads_IsGoodAtEveryLoadBetween) {
  const RigModel rig = floor_rig(10.75);
  const auto estimator = two_load_poly3(rig);
  const auto trials = square(rig);

  const auto evaluation = evaluate_cop(rig, estimator, trials).value();

  EXPECT_LE(evaluation.figures.rms_total_mm, 0.35);
  EXPECT_LE(evaluation.figures.load_rms_percent, 0.5);
  EXPECT_EQ(evaluation.outside_count, 0U);
  // One noisy sample, not an average over time.
  EXPECT_LE(errors(rig, estimator, trials, {.noise = CopNoise::Realistic, .seed = 1}).rms_total_mm, 0.6);
}

TEST(CopAcceptance, Poly3FromModel_HoldsFromLightToHeavy) {
  const RigModel rig = floor_rig(10.75);
  const auto estimator = CopEstimator::from_model(CopMethod::Poly3, rig).value();
  const auto positions = grid_positions(SensorRectangle::of(rig), 11);

  EXPECT_LE(errors(rig, estimator, square(rig), {.noise = CopNoise::Realistic, .seed = 2}).rms_total_mm, 0.6);
  for (const double load_n : {200.0, 500.0, 850.0, 980.0}) {
    const auto evaluation = evaluate_cop(rig, estimator, point_trials(positions, std::array{load_n})).value();

    EXPECT_LE(evaluation.figures.rms_total_mm, load_n <= 850.0 ? 0.35 : 0.7) << load_n;
    EXPECT_EQ(evaluation.outside_count, 0U) << load_n;
  }
}

/// Sixteen sensors in the middles of 4 x 4 equal fields of the plate.
RigModel sixteen_sensors() {
  RigModel rig = floor_rig(10.75);
  rig.sensors.clear();
  for (int k = 0; k < 16; ++k) {
    rig.sensors.push_back({.label = "s" + std::to_string(k + 1),
                           .position = test::at(53.75 + 107.5 * (k % 4), 53.75 + 107.5 * (k / 4)),
                           .curve = SensorCurve::hoa1405_assumed()});
  }
  return rig;
}

CopErrorFigures foot_errors(const CopEstimator& estimator, std::size_t feet, PlateBehaviour behaviour) {
  constexpr std::uint64_t kUnseen = 1001;  // not the stances it was calibrated on
  const RigModel rig = sixteen_sensors();
  return errors(rig, estimator, foot_trials(rig.plate, feet, 150, {600.0, 600.0}, kUnseen),
                {.behaviour = behaviour, .noise = CopNoise::Realistic});
}

TEST(CopAcceptance, MomentOfSixteenSensors_MeetsTheSheetUnderFeet) {
  const auto estimator = CopEstimator::from_model(CopMethod::Moment, sixteen_sensors(), PlateBehaviour::Linear).value();
  auto form = std::get<MomentForm>(estimator.form());
  ASSERT_EQ(form.x_quadratic_mm.size(), 136U);
  form.x_quadratic_mm.clear();
  form.y_quadratic_mm.clear();
  const auto ratio = CopEstimator::from_form(CopMethod::Moment, form, estimator.validity()).value();

  const double two_feet_mm = foot_errors(estimator, 2, PlateBehaviour::Linear).rms_total_mm;
  EXPECT_LE(foot_errors(estimator, 1, PlateBehaviour::Linear).rms_total_mm, 0.35);
  EXPECT_LE(two_feet_mm, 0.6);
  EXPECT_GT(foot_errors(ratio, 2, PlateBehaviour::Linear).rms_total_mm, 2.0 * two_feet_mm) << "without quadratic terms";

  // Measured here, as the sheet's sixteen sensors are on a linear plate: 0.77 and 1.13 mm.
  const auto stiffening = CopEstimator::from_model(CopMethod::Moment, sixteen_sensors()).value();
  EXPECT_LE(foot_errors(stiffening, 1, PlateBehaviour::Stiffening).rms_total_mm, 0.8);
  EXPECT_LE(foot_errors(stiffening, 2, PlateBehaviour::Stiffening).rms_total_mm, 1.2);
}

TEST(CopAcceptance, FourSensorsUnderFeet_ErrAsTheStudysDo) {
  // Plate-model section 6: about 2 mm for one foot, 4 to 4.6 mm for two. Holds the library of stances to the study's.
  const RigModel rig = floor_rig(10.75);
  const auto estimator = CopEstimator::from_model(CopMethod::Poly3, rig, PlateBehaviour::Linear).value();
  const CopEvaluationOptions linear{.behaviour = PlateBehaviour::Linear};

  EXPECT_NEAR(errors(rig, estimator, foot_trials(rig.plate, 1, 300, {600.0, 600.0}, 5), linear).rms_total_mm, 1.8, 0.3);
  EXPECT_NEAR(errors(rig, estimator, foot_trials(rig.plate, 2, 300, {600.0, 600.0}, 5), linear).rms_total_mm, 4.3, 0.3);
}

TEST(CopAcceptance, ModelOnItsOwnPlate_IsExactButForItsTable) {
  const RigModel rig = floor_rig(10.75);
  const auto linear = CopEstimator::from_model(CopMethod::Model, rig, PlateBehaviour::Linear).value();
  constexpr std::array<double, 2> kLoadsN{50.0, 686.0};

  const auto figures = errors(rig, linear, point_trials(grid_positions({{20.0}, {410.0}, {20.0}, {410.0}}, 9), kLoadsN),
                              {.behaviour = PlateBehaviour::Linear});

  EXPECT_LT(figures.max_total_mm, 1e-5);
  EXPECT_LT(figures.load_rms_percent, 1e-6);

  const auto stiffening = CopEstimator::from_model(CopMethod::Model, rig).value();
  const auto evaluation = evaluate_cop(rig, stiffening, square(rig)).value();
  EXPECT_LT(evaluation.figures.max_total_mm, 0.05);
  EXPECT_LT(evaluation.figures.load_rms_percent, 0.05);
  EXPECT_EQ(evaluation.outside_count, 0U);
  // Between the last two loads of its table.
  const std::array heavy_n{0.98 * stiffening.validity().load_n.highest};
  const auto heavy = evaluate_cop(rig, stiffening, point_trials(grid_positions(SensorRectangle::of(rig), 4), heavy_n)).value();
  EXPECT_LT(heavy.figures.max_total_mm, 0.05);
  EXPECT_LT(heavy.figures.load_rms_percent, 0.05);
}

TEST(CopAcceptance, LinearModelUnderALoadThatStiffensThePlate_IsFlagged) {
  const RigModel rig = floor_rig(10.75);
  const auto estimator = CopEstimator::from_model(CopMethod::Model, rig, PlateBehaviour::Linear).value();

  const auto evaluation = evaluate_cop(rig, estimator, table_41()).value();

  EXPECT_EQ(evaluation.outside_count, 15U);
  EXPECT_GT(evaluation.figures.rms_total_mm, 2.0);  // research: 2.1 to 4.9 mm at 490 N
}

}  // namespace
}  // namespace dts::physics
