// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/special_numbers.h"
#include "unit/pipeline/standing_force.h"

namespace dts::pipeline {
namespace {

using core::kNaN;
using core::quality::kOutOfRange;
using core::quality::kRail;
using core::quality::kUntared;
using testing::Each;
using testing::ElementsAre;

using Options = std::map<std::string, OptionValue, std::less<>>;

std::vector<std::string> names_of(const core::StreamFormat& format) {
  std::vector<std::string> names;
  for (const core::ChannelFormat& channel : format.channels) names.push_back(channel.name + " " + channel.unit);
  return names;
}

/// The stage at 10 Hz, with a tare of 1 s.
class ForcePlateStage {
 public:
  explicit ForcePlateStage(physics::ForcePlateModel plate, const Options& options = {})
      : surroundings_(with_force_plate(std::move(plate))), stage_(surroundings_.make({.id = "force_plate", .options = options})) {
    const std::size_t channels = surroundings_.rig.force_plate->plate.channel_count();
    format_ = stage_->prepare(make_signal(10, "V", std::vector<std::vector<double>>(channels)).format, 64).value();
  }
  /// `scans` scans in which channel c is at `volts[c]` + `slope_v[c]` x seconds since the first scan ever.
  Output run(std::size_t scans, const std::vector<double>& volts, double slope_v_per_s = 0.0, double noise_v = 0.0) {
    std::vector<std::vector<double>> columns(volts.size());
    for (std::size_t i = 0; i < scans; ++i) {
      for (std::size_t c = 0; c < volts.size(); ++c) {
        const double seconds = static_cast<double>(next_ + i) / 10.0;
        columns[c].push_back(volts[c] + slope_v_per_s * seconds + (i % 2 == 0 ? noise_v : -noise_v));
      }
    }
    next_ += scans;
    return run(make_signal(10, "V", columns));
  }
  Output run(const Signal& signal) {
    const std::size_t block_size = 64;
    return pipeline::run(*stage_, format_.channels.size(), signal, std::span(&block_size, 1));
  }
  TareReport report() { return surroundings_.tare.latest(); }
  Tare& tare() { return surroundings_.tare; }
  Stage* operator->() { return stage_.get(); }
  const core::StreamFormat& format() { return format_; }

 private:
  StageSurroundings surroundings_;
  std::unique_ptr<Stage> stage_;
  core::StreamFormat format_;
  std::size_t next_ = 0;
};

const Options kOnlyOnRequest{{"tare_at_start", "no"}};

/// Volts of the cells under `load_n` at the centre.
std::vector<double> cells_under(double load_n) { return std::vector<double>(4, load_n / 400.0); }

std::vector<double> last(const Output& output) {
  std::vector<double> values;
  for (const auto& column : output.values) values.push_back(column.back());
  return values;
}

/// The channels 5 7 -4 -6 200 180 150 170 N of the sheet on force plates: action (12, -10, 700) N, Mx' 12480, My' -4224, Mz 640 N mm.
TEST(ForcePlateStage, KistlerChannels_BecomeTheReactionInTheSubjectsFrame) {
  ForcePlateStage stage(kistler_plate(), kOnlyOnRequest);

  const Output output = stage.run(1, {5 / 25.0, 7 / 25.0, -4 / 25.0, -6 / 25.0, 200 / 250.0, 180 / 250.0, 150 / 250.0, 170 / 250.0});

  EXPECT_THAT(names_of(stage.format()), ElementsAre("fx_n N", "fy_n N", "fz_n N", "mx_nm N m", "my_nm N m", "mz_nm N m"));
  const std::vector<double> expected{-12, -10, 700, -12.480, -4.224, 0.640};
  for (std::size_t c = 0; c < expected.size(); ++c) EXPECT_NEAR(output.values[c][0], expected[c], 1e-9) << c;
  for (const auto& bits : output.bits) EXPECT_THAT(bits, Each(kUntared));
}

TEST(ForcePlateStage, LoadCells_HaveNoShearAndNoFreeMoment) {
  ForcePlateStage stage(cell_plate(), kOnlyOnRequest);

  const Output output = stage.run(1, {2.0, 1.0, 0.5, 1.5});  // 500 N, of which 350 N at x = 200 and 300 N at y = 150

  EXPECT_THAT(names_of(stage.format()), ElementsAre("fz_n N", "mx_nm N m", "my_nm N m"));
  EXPECT_NEAR(output.values[0][0], 500.0, 1e-9);
  EXPECT_NEAR(output.values[1][0], (300.0 - 200.0) * 0.150, 1e-9);
  EXPECT_NEAR(output.values[2][0], -(350.0 - 150.0) * 0.200, 1e-9);
}

TEST(ForcePlateStage, AFaultOfOneChannel_MakesTheScanNaNWithItsReason) {
  ForcePlateStage stage(cell_plate(), kOnlyOnRequest);
  Signal signal = make_signal(10, "V", {{1, kNaN, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}});
  signal.bits[3][2] = kRail;

  const Output output = stage.run(signal);

  for (std::size_t c = 0; c < output.values.size(); ++c) {
    EXPECT_TRUE(std::isfinite(output.values[c][0]));
    EXPECT_TRUE(std::isnan(output.values[c][1]));
    EXPECT_TRUE(std::isnan(output.values[c][2]));
    EXPECT_THAT(output.bits[c], ElementsAre(kUntared, kUntared | kOutOfRange, kUntared | kRail));
  }
}

TEST(ForcePlateStage, AnEmptyPlate_IsTaredAtTheStartPerChannel) {
  ForcePlateStage stage(cell_plate());

  const Output average = stage.run(10, {0.05, -0.02, 0.01, 0.0});
  const Output tared = stage.run(1, {2.05, 0.98, 0.51, 1.5});

  EXPECT_THAT(average.bits[0], Each(kUntared));
  EXPECT_THAT(tared.bits[0], Each(0));
  EXPECT_NEAR(tared.values[0][0], 500.0, 1e-9);
  EXPECT_NEAR(tared.values[1][0], 15.0, 1e-9);
  EXPECT_NEAR(tared.values[2][0], -40.0, 1e-9);
  EXPECT_EQ(stage.report().outcome, TareOutcome::Done);
  EXPECT_EQ(stage.report().unit, ZeroUnit::Volts);
  EXPECT_EQ(stage.report().channel_count, 4U);
  EXPECT_NEAR(stage.report().baseline[1], -0.02, 1e-12);
}

TEST(ForcePlateStage, TheZeroOfTheRigFile_IsUsedUntilATareAndDecidesWhatIsLoaded) {
  physics::ForcePlateModel plate = cell_plate();
  plate.tare_v = {1.5, 1.5, 1.5, 1.5};  // amplifiers at mid-scale
  ForcePlateStage stage(plate);

  const Output before = stage.run(1, {1.6, 1.6, 1.6, 1.6});
  EXPECT_NEAR(before.values[0][0], 40.0, 1e-9);
  EXPECT_THAT(before.bits[0], Each(kUntared));
  EXPECT_NEAR(last(stage.run(10, {1.6, 1.6, 1.6, 1.6}))[0], 0.0, 1e-9);
  EXPECT_EQ(stage.report().outcome, TareOutcome::Done);

  ForcePlateStage loaded(plate);
  (void)loaded.run(10, {1.8, 1.8, 1.8, 1.8});
  EXPECT_EQ(loaded.report().outcome, TareOutcome::Loaded);
  ForcePlateStage without(cell_plate());
  (void)without.run(10, {1.6, 1.6, 1.6, 1.6});
  EXPECT_EQ(without.report().outcome, TareOutcome::Loaded);
}

TEST(ForcePlateStage, ATare_IsRejectedUnderALoadWhileThePlateMovesAndWithAFault) {
  struct Row {
    double load_n;
    double noise_v;
    std::uint8_t fault;
    TareOutcome outcome;
  };
  for (const Row& row : {Row{99, 0, 0, TareOutcome::Done}, Row{101, 0, 0, TareOutcome::Loaded}, Row{-101, 0, 0, TareOutcome::Loaded},
                         Row{0, 0.012, 0, TareOutcome::Done}, Row{0, 0.013, 0, TareOutcome::Unsteady},  // 400 N/V: 4.8 and 5.2 N rms
                         Row{0, 0, kRail, TareOutcome::BadSensor}}) {
    ForcePlateStage stage(cell_plate(), kOnlyOnRequest);
    EXPECT_EQ(stage.tare().request(), 1U);
    Signal signal = make_signal(10, "V", std::vector<std::vector<double>>(4));
    for (std::size_t c = 0; c < 4; ++c) {
      for (int i = 0; i < 10; ++i) signal.values[c].push_back(row.load_n / 400.0 + (i % 2 == 0 ? row.noise_v : -row.noise_v));
      signal.bits[c].assign(10, 0);
    }
    signal.bits[2][5] = row.fault;

    (void)stage.run(signal);

    EXPECT_EQ(stage.report().outcome, row.outcome) << row.load_n << " N, " << row.noise_v << " V";
    EXPECT_EQ(stage.report().request, 1U);
  }
}

TEST(ForcePlateStage, ARejectedTare_LeavesTheEarlierOneInUse) {
  RecordProperty("requirement", "SIG-6");
  ForcePlateStage stage(cell_plate());
  (void)stage.run(10, cells_under(8.0));
  (void)stage.tare().request();

  const Output output = stage.run(12, cells_under(708.0));

  EXPECT_EQ(stage.report().outcome, TareOutcome::Loaded);
  EXPECT_TRUE(stage.report().is_older_in_use);
  EXPECT_NEAR(last(output)[0], 700.0, 1e-9);
  EXPECT_THAT(output.bits[0], Each(0));
}

TEST(ForcePlateStage, ACancelledTare_ChangesNothing) {
  ForcePlateStage stage(cell_plate(), kOnlyOnRequest);
  stage.tare().cancel(stage.tare().request());

  (void)stage.run(10, cells_under(8.0));

  EXPECT_EQ(stage.report().outcome, TareOutcome::None);
  EXPECT_NEAR(last(stage.run(1, cells_under(8.0)))[0], 8.0, 1e-9);
}

/// 400 N/V in all: 0.5 mV/s are 12 N/min.
TEST(ForcePlateStage, TheDriftOfTheEmptyPlate_IsReportedAndMakesALongTrialDoubtful) {
  ForcePlateStage stage(cell_plate());
  (void)stage.run(10, cells_under(0), 0.0005);
  EXPECT_FALSE(stage.report().drift_n_per_min);

  const Output empty = stage.run(210, cells_under(0), 0.0005);  // the window of 20 s begins after the tare
  ASSERT_TRUE(stage.report().drift_n_per_min);
  EXPECT_NEAR(*stage.report().drift_n_per_min, 12.0, 1e-6);
  EXPECT_EQ(stage.report().outcome, TareOutcome::Done);
  EXPECT_THAT(empty.bits[0], Each(0));

  // 1 % of 600 N are reached 30 s after the middle of the tare, of which 21.5 s are over.
  const Output standing = stage.run(400, cells_under(600), 0.0005);
  std::size_t good = 0;
  while (good < 400 && standing.bits[0][good] == 0) ++good;
  EXPECT_NEAR(static_cast<double>(good), 86.0, 4.0);
  EXPECT_THAT(std::vector(standing.bits[0].begin() + static_cast<std::ptrdiff_t>(good), standing.bits[0].end()), Each(kUntared));

  EXPECT_THAT(stage.run(5, cells_under(0)).bits[0], Each(0)) << "the person has left";
}

TEST(ForcePlateStage, DriftOnTheEmptyPlate_MakesATrialDoubtfulFromItsStart_UntilATare) {
  ForcePlateStage stage(cell_plate());
  (void)stage.run(610, cells_under(0), 0.0005);  // 12 N in 60 s

  EXPECT_THAT(stage.run(50, cells_under(600), 0.0005).bits[0], Each(kUntared));

  (void)stage.tare().request();
  (void)stage.run(10, cells_under(0), 0.0005);
  EXPECT_THAT(stage.run(50, cells_under(600), 0.0005).bits[0], Each(0));
}

TEST(ForcePlateStage, AnEmptyPlateThatDriftsFar_IsStillEmpty) {
  ForcePlateStage stage(cell_plate());

  const Output output = stage.run(1510, cells_under(0), 0.0005);  // 30 N in 150 s

  EXPECT_GT(last(output)[0], 29.0);
  EXPECT_EQ(output.bits[0].back(), kUntared) << "what comes after would take it for a person";
  EXPECT_NEAR(*stage.report().drift_n_per_min, 12.0, 1e-6);
  (void)stage.run(400, cells_under(0), 0.0001);
  EXPECT_LT(*stage.report().drift_n_per_min, 10.0) << "it is measured on";
}

TEST(ForcePlateStage, SlowNoiseOfTheEmptyPlate_IsNoDriftForALongTrial) {
  ForcePlateStage stage(cell_plate());
  const auto noise = [](std::size_t scan) { return 0.7 / 400.0 * std::sin(2.0 * std::numbers::pi * static_cast<double>(scan) / 370.0); };
  Signal signal = make_signal(10, "V", std::vector<std::vector<double>>(4));
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t scan = 0; scan < 7000; ++scan) signal.values[c].push_back(noise(scan) + (scan < 1010 ? 0.0 : 600.0 / 400.0));
    signal.bits[c].assign(7000, 0);
  }

  EXPECT_EQ(std::ranges::count(stage.run(signal).bits[0], kUntared), 10) << "only before the tare: 0.7 N, 37 s long; 10 min of standing";
}

TEST(ForcePlateStage, AGapUnderAPerson_KeepsTheDoubt) {
  ForcePlateStage stage(cell_plate());
  (void)stage.run(610, cells_under(0), 0.0005);
  (void)stage.run(20, cells_under(600), 0.0005);

  stage->reset();

  EXPECT_THAT(stage.run(20, cells_under(600), 0.0005).bits[0], Each(kUntared));
}

TEST(ForcePlateStage, ALittleDrift_IsNoDoubt) {
  ForcePlateStage stage(cell_plate());
  (void)stage.run(220, cells_under(0), 0.00005);  // 1.2 N/min

  EXPECT_THAT(stage.run(600, cells_under(600), 0.00005).bits[0], Each(0));  // 1.6 N after 82 s
  EXPECT_NEAR(*stage.report().drift_n_per_min, 1.2, 1e-6);
}

TEST(ForcePlateStage, APersonOrAFaultInTheWindow_BeginsItAgain) {
  ForcePlateStage stage(cell_plate());
  (void)stage.run(10, cells_under(0), 0.0005);
  (void)stage.run(199, cells_under(0), 0.0005);
  (void)stage.run(1, cells_under(600), 0.0005);
  (void)stage.run(209, cells_under(0), 0.0005);  // 1 s after the step, and 199 scans
  EXPECT_FALSE(stage.report().drift_n_per_min);
  (void)stage.run(1, cells_under(0), 0.0005);
  ASSERT_TRUE(stage.report().drift_n_per_min);

  stage->reset();  // a gap: nobody knows how long it was
  (void)stage.run(110, cells_under(0), -0.001);
  (void)stage.run(1, {kNaN, 0, 0, 0});
  (void)stage.run(399, cells_under(0), -0.001);
  EXPECT_NEAR(*stage.report().drift_n_per_min, 12.0, 1e-6);
  (void)stage.run(1, cells_under(0), -0.001);  // the second window after the gap
  EXPECT_NEAR(*stage.report().drift_n_per_min, -24.0, 1e-6);
}

}  // namespace
}  // namespace dts::pipeline
