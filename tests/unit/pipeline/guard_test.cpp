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

TEST(Guard, Values_AreMarkedOneByOne) {
  struct Row {
    const char* name;
    double resolution_v;
    std::vector<double> volts;
    std::vector<std::uint8_t> bits;
  };
  for (const Row& row : {Row{"good", 0.01, {1.0, -2.5, 4.97}, {0, 0, 0}},
                         {"within a code of the ends", 0.01, {-5.0, -4.99, -4.98, 4.98, 4.99, 5.0}, {kRail, kRail, 0, 0, kRail, kRail}},
                         {"converter without codes", 0.0, {-5.0, -4.9999, 4.9999, 5.0, 5.1}, {kRail, 0, 0, kRail, kRail}},
                         {"not finite", 0.01, {1.0, kNaN, kInfinity, -kInfinity}, {0, kOutOfRange, kOutOfRange, kOutOfRange}}}) {
    SCOPED_TRACE(row.name);
    for (const std::uint8_t of_device : {std::uint8_t{0}, kRotation}) {
      OneSensor guard({}, row.resolution_v);
      Signal signal = make_signal(100, "V", {row.volts});
      std::ranges::fill(signal.bits[0], of_device);

      const Output output = prepare_and_run(*guard.stage, signal);

      for (std::size_t i = 0; i < row.volts.size(); ++i) {
        EXPECT_EQ(output.bits[0][i], row.bits[i] | of_device) << i;
        EXPECT_TRUE(std::isfinite(row.volts[i]) ? output.values[0][i] == row.volts[i] : std::isnan(output.values[0][i])) << row.volts[i];
      }
    }
  }
}

TEST(Guard, SameValueForLong_IsStuckUntilItMoves) {
  RecordProperty("requirement", "SIG-7");
  struct Row {
    double hz;
    double stuck_ms;
    std::size_t first;  // that is marked, of 151
  };
  for (const auto& [hz, stuck_ms, first] : {Row{100.0, 1000.0, 101}, {100.0, 500.0, 51}, {10.0, 1000.0, 51}, {100.0, 0.0, 151}}) {
    OneSensor guard({{"stuck_ms", stuck_ms}});
    std::vector<double> volts(151, 1.0);
    volts.push_back(1.01);

    const Output output = prepare_and_run(*guard.stage, make_signal(hz, "V", {volts}));

    for (std::size_t i = 0; i < volts.size(); ++i) EXPECT_EQ(output.bits[0][i], i >= first && i < 151 ? kStuck : 0) << first << ", " << i;
  }
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

}  // namespace
}  // namespace dts::pipeline
