// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>

#include "core/special_numbers.h"
#include "unit/pipeline/floor_rig.h"
#include "unit/pipeline/stage_runner.h"

namespace dts::pipeline {
namespace {

using core::kInfinity;
using core::kNaN;
using core::quality::kOutOfRange;
using core::quality::kRail;
using core::quality::kRotation;
using core::quality::kStuck;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

/// A guard over one sensor of +-5 V in steps of 10 mV; other channels are auxiliary.
class OneSensor {
 public:
  explicit OneSensor(std::map<std::string, OptionValue, std::less<>> options = {}, double resolution_v = 0.01) {
    const StageContext context{.rig = rig_,
                               .input_ranges = {{.minimum_v = -5.0, .maximum_v = 5.0, .resolution_v = resolution_v}},
                               .tare = tare_,
                               .windows = windows_};
    stage = create_stage({.id = "guard", .options = std::move(options)}, context).value();
  }

  std::unique_ptr<Stage> stage;

 private:
  physics::RigModel rig_ = floor_rig();
  Tare tare_;
  SteadinessWindows windows_;
};

std::vector<double> rising_volts(std::size_t scans) {
  std::vector<double> volts;
  for (std::size_t i = 0; i < scans; ++i) volts.push_back(0.01 * static_cast<double>(i));
  return volts;
}

TEST(Guard, GoodVolts_PassUnmarked) {
  OneSensor guard;

  const Output output = prepare_and_run(*guard.stage, make_signal(100, "V", {{1.0, -2.5, 4.97}}));

  EXPECT_THAT(output.values[0], ElementsAre(1.0, -2.5, 4.97));
  EXPECT_THAT(output.bits[0], Each(0));
  EXPECT_THAT(output.scan, ElementsAre(0, 1, 2));
}

TEST(Guard, WithinOneCodeOfTheEnds_MarksRail) {
  OneSensor guard;

  const Output output = prepare_and_run(*guard.stage, make_signal(100, "V", {{-5.0, -4.99, -4.98, 4.98, 4.99, 5.0}}));

  EXPECT_THAT(output.bits[0], ElementsAre(kRail, kRail, 0, 0, kRail, kRail));
}

TEST(Guard, ConverterWithoutCodes_MarksOnlyItsEndsAsRail) {
  OneSensor guard({}, 0.0);

  const Output output = prepare_and_run(*guard.stage, make_signal(100, "V", {{-5.0, -4.9999, 4.9999, 5.0, 5.1}}));

  EXPECT_THAT(output.bits[0], ElementsAre(kRail, 0, 0, kRail, kRail));
}

TEST(Guard, SameValueLongerThanASecond_MarksStuckUntilItMoves) {
  OneSensor guard;
  std::vector<double> volts(103, 1.0);  // 100 repeats last a second at 100 Hz: scan 101 is the first that is longer
  volts.push_back(1.01);

  const Output output = prepare_and_run(*guard.stage, make_signal(100, "V", {volts}));

  EXPECT_EQ(output.bits[0][100], 0);
  EXPECT_EQ(output.bits[0][101], kStuck);
  EXPECT_EQ(output.bits[0][102], kStuck);
  EXPECT_EQ(output.bits[0][103], 0);
}

TEST(Guard, SlowRate_WaitsForFiftyScansBeforeStuck) {
  OneSensor guard;

  const Output output = prepare_and_run(*guard.stage, make_signal(10, "V", {std::vector<double>(52, 1.0)}));

  EXPECT_EQ(output.bits[0][50], 0);
  EXPECT_EQ(output.bits[0][51], kStuck);
}

TEST(Guard, StuckMsZero_NeverMarksStuck) {
  OneSensor guard({{"stuck_ms", 0.0}});

  const Output output = prepare_and_run(*guard.stage, make_signal(100, "V", {std::vector<double>(1000, 1.0)}));

  EXPECT_THAT(output.bits[0], Each(0));
}

TEST(Guard, ResetWhileStuck_CountsAnew) {
  OneSensor guard;
  const Signal signal = make_signal(100, "V", {std::vector<double>(101, 1.0)});
  const Output before = prepare_and_run(*guard.stage, signal);
  const std::size_t block_size = 64;

  guard.stage->reset();
  const Output after = run(*guard.stage, 1, signal, std::span(&block_size, 1));

  EXPECT_THAT(before.bits[0], Each(0));
  EXPECT_THAT(after.bits[0], Each(0));  // without the reset all scans would be repeats 101 and more
}

TEST(Guard, NotFinite_BecomesNaNOutOfRange) {
  OneSensor guard;

  const Output output = prepare_and_run(*guard.stage, make_signal(100, "V", {{1.0, kNaN, kInfinity, -kInfinity, 2.0}}));

  EXPECT_THAT(output.bits[0], ElementsAre(0, kOutOfRange, kOutOfRange, kOutOfRange, 0));
  for (const std::size_t i : {1U, 2U, 3U}) EXPECT_TRUE(std::isnan(output.values[0][i])) << i;
}

TEST(Guard, BitsOfTheDevice_Stay) {
  OneSensor guard;
  Signal signal = make_signal(100, "V", {{1.0, 5.0}});
  signal.bits[0] = {kRotation, kRotation};

  const Output output = prepare_and_run(*guard.stage, signal);

  EXPECT_THAT(output.bits[0], ElementsAre(kRotation, kRotation | kRail));
}

TEST(Guard, MarkerOffItsVoltage_MarksTheScanOfEverySensor) {
  StageSurroundings surroundings;
  const auto guard =
      surroundings.make({.id = "guard", .options = {{"marker_channel", 1.0}, {"marker_v", 2.0}, {"marker_tolerance_v", 0.5}}});
  const std::vector<double> sensor = rising_volts(5);
  const std::vector<double> unrelated(5, 0.0);
  const std::vector<double> marker{2.0, 2.5, 1.5, 1.4, kNaN};

  const Output output = prepare_and_run(*guard, make_signal(100, "V", {sensor, sensor, sensor, sensor, unrelated, marker}));

  ASSERT_EQ(output.bits.size(), 4U);
  for (const auto& bits : output.bits) EXPECT_THAT(bits, ElementsAre(0, 0, 0, kRotation, kRotation));
}

TEST(Guard, Prepare_DropsTheAuxiliaryChannels) {
  StageSurroundings surroundings;
  Signal signal = make_signal(100, "V", {{}, {}, {}, {}, {}});
  signal.format.channels[4].unit = "mm";

  const auto output = surroundings.make({.id = "guard", .options = {}})->prepare(signal.format, 64);

  ASSERT_TRUE(output);
  EXPECT_EQ(output->channels.size(), 4U);
  EXPECT_EQ(output->rate, signal.format.rate);
}

TEST(Guard, PrepareMarkerThatDoesNotExist_IsRefused) {
  StageSurroundings surroundings;
  const auto guard = surroundings.make({.id = "guard", .options = {{"marker_channel", 1.0}}});

  const auto output = guard->prepare(make_signal(100, "V", {{}, {}, {}, {}, {}}).format, 64);

  ASSERT_FALSE(output);
  EXPECT_EQ(output.error().code, core::ErrorCode::InvalidArgument);
  EXPECT_THAT(output.error().what, HasSubstr("'marker_channel' is 1, but the device has 1 channels beside the sensors"));
}

TEST(Guard, PrepareSenselessInput_IsRefused) {
  StageSurroundings surroundings;
  const auto guard = surroundings.make({.id = "guard", .options = {}});

  EXPECT_FALSE(guard->prepare(make_signal(100, "V", {{}, {}, {}}).format, 64));  // four sensors have a range
  EXPECT_FALSE(guard->prepare(make_signal(100, "mm", {{}, {}, {}, {}}).format, 64));
}

}  // namespace
}  // namespace dts::pipeline
