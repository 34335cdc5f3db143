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

using Options = std::map<std::string, OptionValue, std::less<>>;
const Options kNoTareAtStart{{"tare_at_start", "no"}};

/// The stage over `straight_rig`.
class Linearise {
 public:
  explicit Linearise(const Options& options = {}) {
    stage_ = surroundings_.make({.id = "linearise", .options = options});
    format_ = stage_->prepare(resting(0, 0, 0).format, 64).value();
  }
  Output run(const Signal& signal) {
    const std::size_t block_size = 64;
    return pipeline::run(*stage_, 2, signal, std::span(&block_size, 1));
  }
  const TareReport& report() { return surroundings_.tare.latest(); }
  Tare& tare() { return surroundings_.tare; }
  Stage& operator*() { return *stage_; }
  Stage* operator->() { return stage_.get(); }
  const core::StreamFormat& format() { return format_; }

 private:
  StageSurroundings surroundings_{straight_rig()};
  std::unique_ptr<Stage> stage_;
  core::StreamFormat format_;
};

TEST(LineariseStage, Volts_BecomeDeflectionFromTheUnloadedGap) {
  RecordProperty("requirement", "SIG-1");
  Linearise linearise(kNoTareAtStart);

  const Output output = linearise.run(make_signal(100, "V", {{1.0, 2.0, 4.75}, {1.0, 0.5, 1.25}}));

  EXPECT_NEAR(output.values[0][0], 0.0, kTableMm);
  EXPECT_NEAR(output.values[0][1], 2.0, kTableMm);
  EXPECT_NEAR(output.values[0][2], 7.5, kTableMm);
  EXPECT_NEAR(output.values[1][1], -1.0, kTableMm);
  EXPECT_NEAR(output.values[1][2], 0.5, kTableMm);
  EXPECT_THAT(output.bits[0], Each(kUntared));
}

TEST(LineariseStage, VoltsBeyondTheCurve_CountAsItsEndAndAreMarked) {
  RecordProperty("requirement", "SIG-1");
  Linearise linearise(kNoTareAtStart);

  const Output output = linearise.run(make_signal(100, "V", {{5.0, 5.01, 0.0, -0.01}, {1.0, 1.0, 1.0, 1.0}}));

  EXPECT_NEAR(output.values[0][1], 8.0, kTableMm);
  EXPECT_NEAR(output.values[0][3], -2.0, kTableMm);
  EXPECT_THAT(output.bits[0], ElementsAre(kUntared, kUntared | kOutOfRange, kUntared, kUntared | kOutOfRange));
  EXPECT_THAT(output.bits[1], Each(kUntared));
}

TEST(LineariseStage, NotFinite_BecomesNaNOutOfRange) {
  Linearise linearise(kNoTareAtStart);

  const Output output = linearise.run(make_signal(100, "V", {{kNaN, std::numeric_limits<double>::infinity()}, {1.0, 1.0}}));

  for (const double value : output.values[0]) EXPECT_TRUE(std::isnan(value));
  EXPECT_THAT(output.bits[0], Each(kUntared | kOutOfRange));
}

TEST(LineariseStage, Tare_TakesTheMeanOfAnEmptyPlateThatIsStill) {
  RecordProperty("requirement", "SIG-6");
  enum class Act { None, Tare, Reset, Prepare };
  constexpr auto kTare = Act::Tare;
  struct Part {
    std::size_t scans;
    double first_mm;
    double second_mm;
    Act before = Act::None;
    double swing_mm = 0.0;        ///< Of the second sensor, from scan to scan: its rms.
    std::uint8_t fault_bits = 0;  ///< Of the second sensor, once.
  };
  struct Row {
    const char* name;
    Options options;
    std::vector<Part> parts;
    TareOutcome outcome;
    std::uint64_t request;
    double first_mm;  // of the last scan ...
    double second_mm;
    std::uint8_t bits;  // ... and what is said of it
    bool is_older_in_use = false;
  };
  const Options& no = kNoTareAtStart;
  const Options nominal{{"baseline", "nominal"}, {"tare_at_start", "if_empty"}};
  using enum TareOutcome;
  const std::vector<Row> rows{
      {"half way", no, {{99, 0.1, -0.2, kTare}}, Running, 1, 0.1, -0.2, kUntared},
      {"done: still the old zero within its last scan", no, {{100, 0.1, -0.2, kTare}}, Done, 1, 0.1, -0.2, kUntared},
      {"in use from the next scan on", no, {{101, 0.1, -0.2, kTare}}, Done, 1, 0.0, 0.0, 0},
      {"just below the limit", no, {{100, 0.49, -0.49, kTare}, {1, 0.49, 0.0}}, Done, 1, 0.0, 0.49, 0},
      {"loaded, whatever the baseline", no, {{100, 0.1, 0.2, kTare}, {101, 0.1, 0.51, kTare}}, Loaded, 2, 0.0, 0.31, 0, true},
      {"nearly still", no, {{101, 0.1, 0.1, kTare, 0.09}}, Done, 1, 0.0, 0.09, 0},
      {"not still", no, {{101, 0.1, 0.1, kTare, 0.11}}, Unsteady, 1, 0.1, 0.21, kUntared},
      {"faulty scan", no, {{100, 0.1, 0.1, kTare, 0.0, kRail}, {1, 0.1, 0.1}}, BadSensor, 1, 0.1, 0.1, kUntared},
      {"asked for again", no, {{64, 0.4, 0.4, kTare}, {101, 0.1, 0.1, kTare}}, Done, 2, 0.0, 0.0, 0},
      {"asked for again, half way", no, {{64, 0.4, 0.4, kTare}, {64, 0.1, 0.1, kTare}}, Running, 2, 0.1, 0.1, kUntared},
      {"empty at the start", {}, {{101, 0.3, 0.3}}, Done, 0, 0.0, 0.0, 0},
      {"loaded at the start", {}, {{400, 3.0, 3.0}}, Loaded, 0, 3.0, 3.0, kUntared},
      {"loaded at the start, empty later", {}, {{400, 3.0, 3.0}, {200, 0.3, 0.3}}, Loaded, 0, 0.3, 0.3, kUntared},
      {"empty in the next segment", {}, {{400, 3.0, 3.0}, {101, 0.3, 0.3, Act::Reset}}, Done, 0, 0.0, 0.0, 0},
      {"once for all segments", {}, {{100, 0.3, 0.3}, {200, 0.1, 0.3, Act::Reset}}, Done, 0, -0.2, 0.0, 0},
      {"segment ends during it", no, {{60, 0.4, 0.4, kTare}, {101, 0.1, 0.1, Act::Reset}}, Done, 1, 0.0, 0.0, 0},
      {"nominal: nothing tares itself", nominal, {{200, 0.2, 3.0}}, None, 0, 0.2, 3.0, 0},
      {"nominal: gives way to a command", nominal, {{101, 0.2, 0.1, kTare}}, Done, 1, 0.0, 0.0, 0},
      {"prepared again",
       no,
       {{100, 0.3, 0.3, kTare}, {50, 0.1, 0.1, kTare}, {200, 0.1, 0.1, Act::Prepare}},
       Running,
       2,
       0.1,
       0.1,
       kUntared},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(row.name);
    Linearise fresh(row.options);
    Output output;
    for (const Part& part : row.parts) {
      if (part.before == kTare) fresh.tare().request();
      if (part.before == Act::Reset) fresh->reset();
      if (part.before == Act::Prepare) fresh->prepare(resting(0, 0, 0).format, 64).value();
      Signal signal = resting(part.scans, part.first_mm, part.second_mm);
      for (std::size_t i = 0; i < part.scans; ++i) signal.values[1][i] += 0.5 * (i % 2 == 0 ? part.swing_mm : -part.swing_mm);
      signal.bits[1][part.scans / 2] |= part.fault_bits;
      output = fresh.run(signal);
    }
    EXPECT_EQ(fresh.report().outcome, row.outcome);
    EXPECT_EQ(fresh.report().request, row.request);
    EXPECT_EQ(fresh.report().channel_count, row.outcome == None ? 0U : 2U);
    EXPECT_EQ(fresh.report().is_older_in_use, row.is_older_in_use);
    EXPECT_NEAR(output.values[0].back(), row.first_mm, 2 * kTableMm);
    EXPECT_NEAR(output.values[1].back(), row.second_mm, 2 * kTableMm);
    for (const auto& bits : output.bits) EXPECT_EQ(bits.back(), row.bits);
  }
}

}  // namespace
}  // namespace dts::pipeline
