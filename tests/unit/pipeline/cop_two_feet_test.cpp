// SPDX-License-Identifier: Apache-2.0
// The stage cop of a rig whose calibration has a correction for two feet: 2 mm to the right, 3 mm back, and 10 % more load if the stance
// width is stated, else 20 %.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "support/allocation_counter.h"
#include "unit/physics/cop/constant_two_feet.h"
#include "unit/pipeline/floor_rig.h"
#include "unit/pipeline/stage_runner.h"

namespace dts::pipeline {
namespace {

using core::quality::kUncalibrated;

constexpr std::size_t kSettled = 60;  ///< Scans after which a person has settled: 0.6 s at 100 Hz.

class CopTwoFeetTest : public testing::Test {
 protected:
  CopTwoFeetTest() {
    const auto samples = physics::model_samples(physics::CopMethod::Poly3, surroundings_.rig, physics::PlateBehaviour::Stiffening).value();
    surroundings_.cop_calibration =
        physics::calibrate_cop(physics::CopMethod::Poly3, samples, {.created_utc = "2026-01-31T12:00:00Z", .rig = "floor"}).value();
    surroundings_.cop_calibration->two_feet = physics::TwoFeetCorrection::from_form(physics::test::constant_form()).value();
  }

  /// A person who keeps still: at ml, ap from the plate's centre.
  [[nodiscard]] Signal standing(std::size_t scans, double load_n = 600.0, double ml_mm = 10.0, double ap_mm = -20.0) const {
    std::vector<std::vector<double>> columns(4, std::vector<double>(scans));
    const auto deflection_mm = plate_.deflection_mm({{215.0 + ml_mm}, {215.0 + ap_mm}}, load_n);
    for (std::size_t c = 0; c < 4; ++c) columns[c].assign(scans, deflection_mm[c]);
    return make_signal(100, "mm", columns);
  }
  static void append(Signal& signal, const Signal& more) {
    for (std::size_t c = 0; c < signal.values.size(); ++c) {
      signal.values[c].insert(signal.values[c].end(), more.values[c].begin(), more.values[c].end());
      signal.bits[c].insert(signal.bits[c].end(), more.bits[c].begin(), more.bits[c].end());
    }
  }
  [[nodiscard]] std::unique_ptr<Stage> make() {
    StageContext context = surroundings_.context();
    context.stances = &stances_;
    return create_stage({.id = "cop", .options = {}}, context).value();
  }
  static Output run_in(Stage& stage, const Signal& signal, std::size_t block = 7) { return run(stage, 3, signal, std::span(&block, 1)); }
  static std::vector<double> saved(const Stage& stage) {
    std::vector<double> state(stage.state_size());
    stage.save(state);
    return state;
  }

  StageSurroundings surroundings_;
  FloorPlate plate_{surroundings_.rig};
  SubjectStances stances_;
};

TEST_F(CopTwoFeetTest, PersonWhoHasSettled_IsCorrected) {
  RecordProperty("requirement", "COP-7");
  const Output output = prepare_and_run(*make(), standing(100));

  EXPECT_NEAR(output.values[0][10], 10.0, 0.5) << "while stepping on, the point calibration applies";
  EXPECT_NEAR(output.values[2][10], 600.0, 6.0);
  EXPECT_NEAR(output.values[0][kSettled] - output.values[0][10], 2.0, 1e-9);
  EXPECT_NEAR(output.values[1][kSettled] - output.values[1][10], -3.0, 1e-9);
  EXPECT_NEAR(output.values[2][kSettled] / output.values[2][10], 1.2, 1e-9);
  EXPECT_EQ(output.bits[2][kSettled], 0);
}

TEST_F(CopTwoFeetTest, StatedStanceWidth_IsUsed) {
  stances_.begin(200.0);

  const Output output = prepare_and_run(*make(), standing(100));

  EXPECT_NEAR(output.values[2][kSettled] / output.values[2][10], 1.1, 1e-9);
}

TEST_F(CopTwoFeetTest, WidthBeyondTheCorrection_IsMarkedUncalibrated) {
  stances_.begin(390.0);

  const Output output = prepare_and_run(*make(), standing(100));

  EXPECT_EQ(output.bits[0][10], 0);
  EXPECT_EQ(output.bits[0][kSettled], kUncalibrated);
}

TEST_F(CopTwoFeetTest, DeflectionBeyondTheTravel_IsMarkedOutOfRange_ButHasAValue) {
  physics::TwoFeetForm form = physics::test::constant_form();
  form.travel_mm = plate_.deflection_mm({{225.0}, {195.0}}, 600.0)[0] - 0.01;
  surroundings_.cop_calibration->two_feet = physics::TwoFeetCorrection::from_form(form).value();

  const Output output = prepare_and_run(*make(), standing(100));

  EXPECT_EQ(output.bits[0][10], 0) << "while stepping on, the point calibration applies";
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(output.bits[c][kSettled], core::quality::kOutOfRange | kUncalibrated);
    EXPECT_TRUE(std::isfinite(output.values[c][kSettled]));
  }
}

TEST_F(CopTwoFeetTest, PersonAtTheSide_StandsOnOneFoot) {
  const Output output = prepare_and_run(*make(), standing(200, 600.0, 100.0));

  EXPECT_NEAR(output.values[2][199], 600.0, 6.0);
}

TEST_F(CopTwoFeetTest, SteppingOff_EndsTheCorrection) {
  Signal signal = standing(100);
  append(signal, standing(20, 300.0));
  append(signal, standing(5, 20.0));
  append(signal, standing(20));

  const Output output = prepare_and_run(*make(), signal);

  EXPECT_NEAR(output.values[2][99], 720.0, 8.0);
  EXPECT_NEAR(output.values[2][100], 300.0, 3.0);
  EXPECT_NEAR(output.values[2][144], 600.0, 6.0) << "the next person has not settled";
}

TEST_F(CopTwoFeetTest, TrialOnOneFoot_KeepsThePointCalibrationFromItsScanOn) {
  const auto stage = make();
  ASSERT_TRUE(stage->prepare(standing(1).format, 64));
  const Output before = run_in(*stage, until(standing(200), 80));
  stances_.change_feet(false, 0, core::ScanIndex{100});
  const Output after = run_in(*stage, from(standing(200), 80));

  EXPECT_NEAR(before.values[2][79], 720.0, 8.0);
  EXPECT_NEAR(after.values[2][19], 720.0, 8.0) << "scan 99";
  EXPECT_NEAR(after.values[2][20], 600.0, 6.0) << "scan 100";
  stances_.change_feet(true, 0, core::ScanIndex{150});
  EXPECT_NEAR(run_in(*stage, from(standing(220), 200)).values[2][0], 720.0, 8.0) << "its scan has passed";
}

TEST_F(CopTwoFeetTest, RateOfTheRawStream_CountsForTheScanOfAChange) {
  StageContext context = surroundings_.context();
  context.stances = &stances_;
  context.raw_rate = rate_hz(1000.0);
  const auto stage = create_stage({.id = "cop", .options = {}}, context).value();
  ASSERT_TRUE(stage->prepare(standing(1).format, 64));
  stances_.change_feet(false, 0, core::ScanIndex{800});

  const Output output = run_in(*stage, standing(100));

  EXPECT_NEAR(output.values[2][79], 720.0, 8.0);
  EXPECT_NEAR(output.values[2][80], 600.0, 6.0);
}

TEST_F(CopTwoFeetTest, ResultDoesNotDependOnTheBlocks) {
  Signal signal = standing(90);
  append(signal, standing(30, 600.0, 90.0));
  append(signal, standing(80, 650.0));
  const auto values = [&](std::size_t block) {
    stances_.begin(180.0);
    const auto stage = make();
    EXPECT_TRUE(stage->prepare(signal.format, 64));
    return run_in(*stage, signal, block).values;
  };
  EXPECT_EQ(values(1), values(64));
  EXPECT_EQ(values(1), values(9));
}

TEST_F(CopTwoFeetTest, RestoredState_ContinuesBitForBit) {
  Signal signal = standing(40);
  append(signal, standing(100, 610.0));
  append(signal, standing(60, 400.0));
  for (const std::size_t cut : {std::size_t{5}, std::size_t{45}, std::size_t{120}, std::size_t{150}}) {
    stances_.begin(200.0);
    const auto stage = make();
    ASSERT_TRUE(stage->prepare(signal.format, 64));
    run_in(*stage, until(signal, 1));
    stances_.change_feet(false, 0, core::ScanIndex{130});
    run_in(*stage, from(until(signal, cut), 1));
    const std::vector<double> state = saved(*stage);
    const Output rest = run_in(*stage, from(signal, cut));

    SubjectStances nothing;  // a replay has no session
    StageContext context = surroundings_.context();
    context.stances = &nothing;
    const auto other = create_stage({.id = "cop", .options = {}}, context).value();
    ASSERT_TRUE(other->prepare(signal.format, 64));
    ASSERT_TRUE(other->restore(state));
    EXPECT_EQ(saved(*other), state);
    EXPECT_EQ(run_in(*other, from(signal, cut)).values, rest.values) << cut;
  }
}

TEST_F(CopTwoFeetTest, StateSavedBeforeTheNextBlock_HasTheNewStance) {
  const auto stage = make();
  ASSERT_TRUE(stage->prepare(standing(1).format, 64));
  run_in(*stage, until(standing(200), 80));
  stances_.begin(200.0);  // as a session does just before its recording begins
  const std::vector<double> state = saved(*stage);
  const Output rest = run_in(*stage, from(standing(200), 80));

  SubjectStances nothing;
  StageContext context = surroundings_.context();
  context.stances = &nothing;
  const auto other = create_stage({.id = "cop", .options = {}}, context).value();
  ASSERT_TRUE(other->prepare(standing(1).format, 64));
  ASSERT_TRUE(other->restore(state));

  EXPECT_NEAR(rest.values[2][0], 660.0, 7.0);
  EXPECT_EQ(run_in(*other, from(standing(200), 80)).values, rest.values);
}

TEST_F(CopTwoFeetTest, ImpossibleState_IsRejected) {
  const auto stage = make();
  ASSERT_TRUE(stage->prepare(standing(1).format, 64));
  const std::vector<double> good = saved(*stage);
  ASSERT_TRUE(stage->restore(good));
  EXPECT_FALSE(stage->restore(std::span(good).first(good.size() - 1)));
  EXPECT_FALSE(stage->restore(std::span(good).first(1))) << "of a rig without the correction";
  for (std::size_t k = 0; k < good.size(); ++k) {
    std::vector<double> bad = good;
    bad[k] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(stage->restore(bad)) << k;
    EXPECT_EQ(saved(*stage), good) << "back in its initial state";
  }
}

TEST_F(CopTwoFeetTest, Correction_DoesNotAllocate) {
  const auto stage = make();
  const Signal signal = standing(64);
  ASSERT_TRUE(stage->prepare(signal.format, 64));
  core::Block in(4, 64);
  fill_block(signal, 0, 64, in);
  core::Block out(3, 64);
  out.copy_position(in);
  stances_.begin(180.0);

  const std::uint64_t before = test::heap_calls_of_this_thread();
  stage->process(in, out);
  std::array<double, 16> state{};
  stage->save(std::span(state).first(stage->state_size()));
  const std::uint64_t after = test::heap_calls_of_this_thread();

  EXPECT_EQ(after, before);
  EXPECT_NEAR(out.column(2)[63], 660.0, 7.0);
}

}  // namespace
}  // namespace dts::pipeline
