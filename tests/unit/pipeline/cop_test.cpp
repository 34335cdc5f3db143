// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/allocation_counter.h"
#include "unit/pipeline/floor_rig.h"
#include "unit/pipeline/stage_runner.h"

namespace dts::pipeline {
namespace {

using core::quality::kNoContact;
using core::quality::kOutOfRange;
using core::quality::kRail;
using core::quality::kRotation;
using core::quality::kUncalibrated;
using core::quality::kUntared;

constexpr double kHalfPlateMm = 215.0;

struct PointLoad {
  double ml_mm = 0.0;
  double ap_mm = 0.0;
  double load_n = 490.0;
};

class CopTest : public testing::Test {
 protected:
  /// Deflections of one scan per load, without doubts.
  Signal under(const std::vector<PointLoad>& loads) const {
    std::vector<std::vector<double>> columns(4);
    for (const PointLoad& load : loads) {
      const auto deflection_mm = plate_.deflection_mm({{kHalfPlateMm + load.ml_mm}, {kHalfPlateMm + load.ap_mm}}, load.load_n);
      for (std::size_t c = 0; c < 4; ++c) columns[c].push_back(deflection_mm[c]);
    }
    return make_signal(100, "mm", columns);
  }
  Output run(const Signal& signal, std::map<std::string, OptionValue, std::less<>> options = {}) {
    return prepare_and_run(*surroundings_.make({.id = "cop", .options = std::move(options)}), signal);
  }

  StageSurroundings surroundings_;
  FloorPlate plate_{surroundings_.rig};
};

TEST_F(CopTest, Axes_AreRightAndForwardFromThePlateCentreAndLoadIsInNewtons) {
  RecordProperty("requirement", "COP-1");
  const std::vector<PointLoad> loads{
      {}, {.ml_mm = 60}, {.ml_mm = -20, .ap_mm = 50, .load_n = 300}, {.ml_mm = 40, .ap_mm = -70, .load_n = 600}};
  const Output output = run(under(loads));

  for (std::size_t i = 0; i < loads.size(); ++i) {
    EXPECT_NEAR(output.values[0][i], loads[i].ml_mm, 0.5);  // poly3 inside the sensor square: plate-model 5.2, 0.18 mm rms
    EXPECT_NEAR(output.values[1][i], loads[i].ap_mm, 0.5);
    EXPECT_NEAR(output.values[2][i], loads[i].load_n, 0.01 * loads[i].load_n);
    for (const auto& bits : output.bits) EXPECT_EQ(bits[i], 0);
  }
}

TEST_F(CopTest, BelowTheThreshold_GivesTheLoadButNoPosition) {
  RecordProperty("requirement", "COP-2");
  const Output output = run(under({{.load_n = 30.0}}));

  EXPECT_TRUE(std::isnan(output.values[0][0]));
  EXPECT_TRUE(std::isnan(output.values[1][0]));
  EXPECT_EQ(output.bits[0][0], kNoContact);
  EXPECT_EQ(output.bits[1][0], kNoContact);
  EXPECT_NEAR(output.values[2][0], 30.0, 1.0);
  EXPECT_EQ(output.bits[2][0], 0);
}

TEST_F(CopTest, Contact_BeginsAtTheThresholdAndEndsAtFourFifthsOrAtAReset) {
  Signal signal = under({{.load_n = 45}, {.load_n = 55}, {.load_n = 45}, {.load_n = 42}, {.load_n = 38}, {.load_n = 45}, {.load_n = 55}});
  signal.bits[3][2] = kRail;  // a faulty scan leaves contact as it was
  const auto cop = surroundings_.make({.id = "cop", .options = {}});
  const std::size_t block_size = 64;

  const Output output = prepare_and_run(*cop, signal);
  cop->reset();
  const Output after = pipeline::run(*cop, 3, under({{.load_n = 45}}), std::span(&block_size, 1));

  EXPECT_THAT(output.bits[0], testing::ElementsAre(kNoContact, kUncalibrated, kRail, kUncalibrated, kNoContact, kNoContact, kUncalibrated));
  EXPECT_EQ(after.bits[0][0], kNoContact);
}

TEST_F(CopTest, PlateBentUpwards_IsNoContactAtZeroLoad) {
  const Output output = run(make_signal(100, "mm", {{-0.01}, {-0.01}, {0.005}, {0.0}}));

  EXPECT_EQ(output.bits[0][0], kNoContact);
  EXPECT_EQ(output.values[2][0], 0.0);
}

TEST_F(CopTest, FaultOnOneSensor_MakesTheWholeScanNaNWithAllBits) {
  RecordProperty("requirement", "COP-12");
  Signal signal = under({{}, {}, {}});
  signal.bits[1][0] = kRail;
  signal.bits[2][0] = kRotation | kUntared;
  signal.values[3][1] = std::numeric_limits<double>::quiet_NaN();

  const Output output = run(signal);

  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_TRUE(std::isnan(output.values[c][0]));
    EXPECT_EQ(output.bits[c][0], kRail | kRotation | kUntared);
    EXPECT_TRUE(std::isnan(output.values[c][1]));
    EXPECT_EQ(output.bits[c][1], kOutOfRange);
    EXPECT_TRUE(std::isfinite(output.values[c][2]));
  }
}

TEST_F(CopTest, UntaredDeflection_GivesValuesMarkedUntared) {
  Signal signal = under({{}});
  signal.bits[2][0] = kUntared;

  const Output output = run(signal);

  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_TRUE(std::isfinite(output.values[c][0]));
    EXPECT_EQ(output.bits[c][0], kUntared);
  }
}

TEST_F(CopTest, LoadOutsideTheCalibration_GivesValuesMarkedUncalibrated) {
  RecordProperty("requirement", "COP-8");
  const Output output =
      run(under({{.ml_mm = 180.0}, {.ml_mm = 30.0, .load_n = 100.0}, {.ml_mm = 30.0, .load_n = 600.0}, {.ml_mm = 30.0, .load_n = 1150.0}}));

  for (const auto& bits : output.bits) EXPECT_THAT(bits, testing::ElementsAre(kUncalibrated, kUncalibrated, 0, kUncalibrated));
  EXPECT_NEAR(output.values[0][0], 129.0, 3.0);  // stays at the border: the sensors' line and 1 % of the area beyond
  EXPECT_NEAR(output.values[0][1], 30.0, 3.0);   // by the shape of the lightest calibrated load
}

TEST_F(CopTest, ThesisEstimator_IsGoodOnTheMidLinesAndCoarserOffThem) {
  const Signal signal = under({{.ml_mm = 64.5, .ap_mm = 0}, {.ml_mm = -129, .ap_mm = -129}});

  const Output thesis = run(signal, {{"estimator", "thesis"}});
  const Output poly3 = run(signal, {{"estimator", "poly3"}});

  EXPECT_NEAR(thesis.values[0][0], 64.5, 0.35);           // plate-model 5.1: mid-line points at most 0.35 mm
  EXPECT_GT(std::abs(thesis.values[0][1] + 129.0), 2.5);  // P1 of thesis Table 4.1: 2.70
  EXPECT_LT(std::abs(poly3.values[0][1] + 129.0), 0.5);
}

/// What a calibration file of this rig would hold: Thesis, and every sensor 5 % more sensitive than the model.
physics::CopCalibration thesis_calibration(const physics::RigModel& rig) {
  auto samples = physics::model_samples(physics::CopMethod::Thesis, rig, physics::PlateBehaviour::Stiffening).value();
  for (auto& sample : samples) {
    for (double& w : sample.deflection_mm) w *= 1.05;
  }
  return physics::calibrate_cop(physics::CopMethod::Thesis, samples, {.created_utc = "2026-01-31T12:00:00Z", .rig = "floor"}).value();
}

TEST_F(CopTest, RigWithACalibration_IsEstimatedByIt) {
  surroundings_.cop_calibration = thesis_calibration(surroundings_.rig);

  const Output output = run(under({{.load_n = 490.0}}), {{"estimator", "thesis"}});

  EXPECT_NEAR(output.values[2][0], 490.0 / 1.05, 2.0);
}

void mount_sixteen_sensors(physics::RigModel& rig) {
  rig.sensors.clear();
  for (int k = 0; k < 16; ++k) {
    rig.sensors.push_back({.label = "s" + std::to_string(k + 1),
                           .position = {{53.75 + 107.5 * (k % 4)}, {53.75 + 107.5 * (k / 4)}},
                           .curve = physics::SensorCurve::hoa1405_assumed()});
  }
}

TEST_F(CopTest, SixteenSensors_AreEstimatedByMoment) {
  mount_sixteen_sensors(surroundings_.rig);
  const auto deflection_mm = FloorPlate(surroundings_.rig).deflection_mm({{kHalfPlateMm + 40.0}, {kHalfPlateMm - 20.0}}, 490.0);
  std::vector<std::vector<double>> columns;
  for (const double w : deflection_mm) columns.push_back({w});

  const Output output = run(make_signal(100, "mm", columns), {{"estimator", "moment"}});

  EXPECT_NEAR(output.values[0][0], 40.0, 2.0);
  EXPECT_NEAR(output.values[1][0], -20.0, 2.0);
  EXPECT_NEAR(output.values[2][0], 490.0, 0.05 * 490.0);
}

TEST_F(CopTest, NoEstimator_TouchesTheHeap) {
  for (const std::string estimator : {"poly3", "thesis", "thesis_per_pair", "model", "moment"}) {
    if (estimator == "moment") mount_sixteen_sensors(surroundings_.rig);
    const auto cop = surroundings_.make({.id = "cop", .options = {{"estimator", estimator}}});
    const std::size_t sensors = surroundings_.rig.sensors.size();
    const Signal signal = make_signal(100, "mm", std::vector<std::vector<double>>(sensors, {2.0, 2.1, -1.0}));
    ASSERT_TRUE(cop->prepare(signal.format, 3)) << estimator;
    core::Block in(sensors, 3);
    in.set_count(3);
    for (std::size_t c = 0; c < sensors; ++c) std::ranges::copy(signal.values[c], in.column(c).begin());
    core::Block out(3, 3);
    out.copy_position(in);

    const std::uint64_t before = test::heap_calls_of_this_thread();
    cop->process(in, out);
    const std::uint64_t after = test::heap_calls_of_this_thread();

    EXPECT_EQ(after - before, 0U) << estimator;
    EXPECT_TRUE(std::isfinite(out.column(0)[0])) << estimator;
  }
}

}  // namespace
}  // namespace dts::pipeline
