// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "core/special_numbers.h"
#include "unit/pipeline/floor_rig.h"
#include "unit/pipeline/stage_runner.h"

namespace dts::pipeline {
namespace {

using core::kNaN;
using core::quality::kOutOfRange;
using core::quality::kRail;
using core::quality::kUntared;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
constexpr double kTableMm = 1e-4;  // a curve's tables keep gap -> volts -> gap within this

/// Two sensors on a straight line of 0.5 V/mm from 5 V at 4 mm to 0 V at 14 mm: deflection = 2 mm/V * (V - 1 V).
physics::RigModel straight_rig() {
  physics::RigModel rig;
  for (const char* label : {"w1", "w2"}) {
    rig.sensors.push_back({.label = label,
                           .position = {},
                           .curve = physics::SensorCurve::create("straight", {{{4.0}, {5.0}}, {{14.0}, {0.0}}}).value(),
                           .unloaded_gap = {12.0}});
  }
  return rig;
}

double volts_at(double deflection_mm) { return 1.0 + 0.5 * deflection_mm; }

/// `scans` scans of sensors at constant deflections, 100 Hz.
Signal resting(std::size_t scans, double first_mm, double second_mm) {
  return make_signal(100, "V", {std::vector<double>(scans, volts_at(first_mm)), std::vector<double>(scans, volts_at(second_mm))});
}

class LineariseTest : public testing::Test {
 protected:
  void prepare(std::map<std::string, OptionValue, std::less<>> options) {
    stage_ = surroundings_.make({.id = "linearise", .options = std::move(options)});
    format_ = stage_->prepare(resting(0, 0, 0).format, 64).value();
  }
  Output run(const Signal& signal) {
    const std::size_t block_size = 64;
    return pipeline::run(*stage_, 2, signal, std::span(&block_size, 1));
  }
  const TareReport& report() { return surroundings_.tare.latest(); }

  StageSurroundings surroundings_{straight_rig()};
  std::unique_ptr<Stage> stage_;
  core::StreamFormat format_;
};

TEST_F(LineariseTest, Volts_BecomeDeflectionFromTheUnloadedGap) {
  prepare({{"tare_at_start", "no"}});

  const Output output = run(make_signal(100, "V", {{1.0, 2.0, 4.75}, {1.0, 0.5, 1.25}}));

  EXPECT_NEAR(output.values[0][0], 0.0, kTableMm);
  EXPECT_NEAR(output.values[0][1], 2.0, kTableMm);
  EXPECT_NEAR(output.values[0][2], 7.5, kTableMm);
  EXPECT_NEAR(output.values[1][1], -1.0, kTableMm);
  EXPECT_NEAR(output.values[1][2], 0.5, kTableMm);
  EXPECT_THAT(output.bits[0], Each(kUntared));
}

TEST_F(LineariseTest, Prepare_NamesChannelsAfterTheSensors) {
  prepare({});

  EXPECT_EQ(format_.channels, (std::vector<core::ChannelFormat>{{.name = "w1_mm", .unit = "mm"}, {.name = "w2_mm", .unit = "mm"}}));
}

TEST_F(LineariseTest, VoltsBeyondTheCurve_CountAsItsEndAndAreMarked) {
  prepare({{"tare_at_start", "no"}});

  const Output output = run(make_signal(100, "V", {{5.0, 5.01, 0.0, -0.01}, {1.0, 1.0, 1.0, 1.0}}));

  EXPECT_NEAR(output.values[0][1], 8.0, kTableMm);
  EXPECT_NEAR(output.values[0][3], -2.0, kTableMm);
  EXPECT_THAT(output.bits[0], ElementsAre(kUntared, kUntared | kOutOfRange, kUntared, kUntared | kOutOfRange));
  EXPECT_THAT(output.bits[1], Each(kUntared));
}

TEST_F(LineariseTest, NotFinite_BecomesNaNOutOfRange) {
  prepare({{"tare_at_start", "no"}});

  const Output output = run(make_signal(100, "V", {{kNaN, std::numeric_limits<double>::infinity()}, {1.0, 1.0}}));

  for (const double value : output.values[0]) EXPECT_TRUE(std::isnan(value));
  EXPECT_THAT(output.bits[0], Each(kUntared | kOutOfRange));
}

TEST_F(LineariseTest, TareRequest_TakesTheMeanAsZeroFromTheNextScanOn) {
  prepare({{"tare_at_start", "no"}});
  const std::uint64_t request = surroundings_.tare.request();

  const Output output = run(resting(130, 0.1, -0.2));  // tare_ms 1000 at 100 Hz: scans 0..99

  EXPECT_EQ(report().outcome, TareOutcome::Done);
  EXPECT_EQ(report().request, request);
  EXPECT_EQ(report().channel_count, 2U);
  EXPECT_NEAR(report().baseline_mm[0], 0.1, kTableMm);
  EXPECT_NEAR(report().baseline_mm[1], -0.2, kTableMm);
  EXPECT_NEAR(output.values[0][99], 0.1, kTableMm);
  EXPECT_EQ(output.bits[0][99], kUntared);
  EXPECT_NEAR(output.values[0][100], 0.0, 1e-12);
  EXPECT_NEAR(output.values[1][100], 0.0, 1e-12);
  EXPECT_EQ(output.bits[0][100], 0);
}

TEST_F(LineariseTest, TareHalfWay_IsReportedAsRunning) {
  prepare({{"tare_at_start", "no"}});
  surroundings_.tare.request();

  run(resting(50, 0.1, 0.1));

  EXPECT_EQ(report().outcome, TareOutcome::Running);
  EXPECT_EQ(report().request, 1U);
}

TEST_F(LineariseTest, TareOnALoadedPlate_IsRefusedAndKeepsTheOldBaseline) {
  prepare({{"tare_at_start", "no"}});
  surroundings_.tare.request();
  run(resting(100, 0.1, 0.2));
  surroundings_.tare.request();

  const Output output = run(resting(101, 0.1, 0.51));  // the limit is 0.5 mm from the nominal gap, whatever the baseline

  EXPECT_EQ(report().outcome, TareOutcome::Loaded);
  EXPECT_TRUE(report().is_older_in_use);
  EXPECT_EQ(report().request, 2U);
  EXPECT_NEAR(report().baseline_mm[1], 0.2, kTableMm);
  EXPECT_NEAR(output.values[1][100], 0.31, 2 * kTableMm);
  EXPECT_EQ(output.bits[1][100], 0);
}

TEST_F(LineariseTest, TareJustBelowTheLimit_IsDone) {
  prepare({{"tare_at_start", "no"}});
  surroundings_.tare.request();

  run(resting(100, 0.49, -0.49));

  EXPECT_EQ(report().outcome, TareOutcome::Done);
}

TEST_F(LineariseTest, TareOnAMovingPlate_IsRefusedAsUnsteady) {
  for (const auto& [swing_mm, expected] : {std::pair{0.09, TareOutcome::Done}, {0.11, TareOutcome::Unsteady}}) {
    prepare({{"tare_at_start", "no"}});
    surroundings_.tare.request();
    Signal signal = resting(100, 0.1, 0.1);
    for (std::size_t i = 0; i < 100; ++i) signal.values[1][i] = volts_at(i % 2 == 0 ? swing_mm : -swing_mm);  // rms = swing

    run(signal);

    EXPECT_EQ(report().outcome, expected) << swing_mm;
  }
}

TEST_F(LineariseTest, TareWithAFaultyScan_IsRefusedAsBadSensor) {
  for (const bool is_nan : {true, false}) {
    prepare({{"tare_at_start", "no"}});
    surroundings_.tare.request();
    Signal signal = resting(100, 0.1, 0.1);
    if (is_nan) signal.values[1][50] = kNaN;
    if (!is_nan) signal.bits[1][50] = kRail;

    run(signal);

    EXPECT_EQ(report().outcome, TareOutcome::BadSensor);
    EXPECT_FALSE(report().is_older_in_use);
  }
}

TEST_F(LineariseTest, RequestDuringATare_BeginsAnew) {
  prepare({{"tare_at_start", "no"}});
  surroundings_.tare.request();
  run(resting(64, 0.4, 0.4));
  surroundings_.tare.request();

  run(resting(64, 0.1, 0.1));
  const TareOutcome half_way = report().outcome;
  run(resting(36, 0.1, 0.1));

  EXPECT_EQ(half_way, TareOutcome::Running);
  EXPECT_EQ(report().outcome, TareOutcome::Done);
  EXPECT_EQ(report().request, 2U);
  EXPECT_NEAR(report().baseline_mm[0], 0.1, kTableMm);
}

TEST_F(LineariseTest, EmptyPlateAtStart_TaresItself) {
  prepare({});

  const Output output = run(resting(101, 0.3, 0.3));

  EXPECT_EQ(report().outcome, TareOutcome::Done);
  EXPECT_EQ(report().request, 0U);
  EXPECT_NEAR(output.values[0][100], 0.0, 1e-12);
  EXPECT_EQ(output.bits[0][100], 0);
}

TEST_F(LineariseTest, LoadedPlateAtStart_StaysUntaredUntilAnEmptySegment) {
  prepare({});

  const Output loaded = run(resting(400, 3.0, 3.0));
  const TareOutcome first = report().outcome;
  const Output unloaded = run(resting(200, 0.3, 0.3));  // the same segment: nothing is tared behind the user's back
  stage_->reset();
  const Output next_segment = run(resting(101, 0.3, 0.3));

  EXPECT_EQ(first, TareOutcome::Loaded);
  EXPECT_THAT(loaded.bits[0], Each(kUntared));
  EXPECT_THAT(unloaded.bits[0], Each(kUntared));
  EXPECT_EQ(next_segment.bits[0][100], 0);
  EXPECT_EQ(report().outcome, TareOutcome::Done);
}

TEST_F(LineariseTest, NominalBaseline_IsTaredFromTheStart) {
  prepare({{"baseline", "nominal"}, {"tare_at_start", "if_empty"}});

  const Output output = run(resting(200, 0.2, 3.0));  // loaded or not: nothing tares itself

  EXPECT_NEAR(output.values[0][199], 0.2, kTableMm);
  EXPECT_NEAR(output.values[1][199], 3.0, kTableMm);
  EXPECT_THAT(output.bits[0], Each(0));
  EXPECT_EQ(report().outcome, TareOutcome::None);
}

TEST_F(LineariseTest, NominalBaseline_GivesWayToACommandedTare) {
  prepare({{"baseline", "nominal"}});
  (void)surroundings_.tare.request();
  run(resting(100, 0.2, 0.1));

  const Output output = run(resting(10, 0.2, 0.1));

  EXPECT_NEAR(output.values[0][9], 0.0, kTableMm);
  EXPECT_EQ(report().outcome, TareOutcome::Done);
}

TEST_F(LineariseTest, NewSegment_KeepsTheBaseline) {
  prepare({});
  run(resting(100, 0.3, 0.3));

  stage_->reset();
  const Output output = run(resting(200, 0.1, 0.3));  // tared once: a new segment does not tare again

  EXPECT_NEAR(output.values[0][0], -0.2, 2 * kTableMm);
  EXPECT_NEAR(output.values[0][199], -0.2, 2 * kTableMm);
  EXPECT_THAT(output.bits[0], Each(0));
}

TEST_F(LineariseTest, NewSegmentDuringATare_AveragesTheNewSegmentOnly) {
  prepare({{"tare_at_start", "no"}});
  surroundings_.tare.request();
  run(resting(60, 0.4, 0.4));

  stage_->reset();
  run(resting(100, 0.1, 0.1));

  EXPECT_EQ(report().outcome, TareOutcome::Done);
  EXPECT_NEAR(report().baseline_mm[0], 0.1, kTableMm);
}

TEST_F(LineariseTest, PrepareAgain_ForgetsTareAndBaseline) {
  prepare({{"tare_at_start", "no"}});
  surroundings_.tare.request();
  run(resting(100, 0.3, 0.3));
  surroundings_.tare.request();
  run(resting(50, 0.1, 0.1));  // a second tare is half way

  stage_->prepare(resting(0, 0, 0).format, 64).value();
  const Output output = run(resting(200, 0.1, 0.1));

  EXPECT_NEAR(output.values[0][0], 0.1, kTableMm);
  EXPECT_THAT(output.bits[0], Each(kUntared));
}

TEST_F(LineariseTest, PrepareSenselessInput_IsRefused) {
  prepare({});

  const auto three_channels = stage_->prepare(make_signal(100, "V", {{}, {}, {}}).format, 64);
  const auto millimetres = stage_->prepare(make_signal(100, "mm", {{}, {}}).format, 64);

  ASSERT_FALSE(three_channels);
  EXPECT_THAT(three_channels.error().what, HasSubstr("3 channels come in, but the rig has 2 sensors"));
  ASSERT_FALSE(millimetres);
  EXPECT_THAT(millimetres.error().what, HasSubstr("is in 'mm', not in 'V'"));
}

}  // namespace
}  // namespace dts::pipeline
