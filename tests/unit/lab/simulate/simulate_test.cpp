// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "files/rig_file.h"
#include "lab/base/thesis_setup.h"
#include "lab/compare/recording.h"
#include "lab/simulate/simulated_rig.h"
#include "record/recording.h"
#include "sim/chair_rig.h"
#include "unit/lab/run_fixture.h"

namespace dts::lab::simulate {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<record::RecordedScans> scans_of(const std::string& file) {
  std::vector<record::RecordedScans> scans;
  const auto recording = record::Recording::open(file).value();
  while (auto item = recording->next().value()) {
    if (auto* some = std::get_if<record::RecordedScans>(&*item)) scans.push_back(std::move(*some));
  }
  return scans;
}

/// Bit by bit; all NaNs are one.
bool are_same(const std::vector<record::RecordedScans>& one, const std::vector<record::RecordedScans>& other) {
  return std::ranges::equal(one, other, [](const record::RecordedScans& a, const record::RecordedScans& b) {
    return a.stream == b.stream && a.first_scan == b.first_scan && a.first_time_s == b.first_time_s &&
           std::ranges::equal(a.values, b.values, [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
  });
}

TEST_F(RunTest, SimulateWithTheSameSeed_GivesTheSameDataAndTruth) {
  const auto simulate = [&](const std::string& name, const std::string& seed) {
    EXPECT_EQ(run_with({"simulate", "floor", "--duration", "6", "--rate", "100", "--seed", seed, "--out", path(name + ".xdf"), "--truth",
                        path(name + ".csv"), "--json"}),
              cli::kOk)
        << talk();
    EXPECT_EQ(json()["scans"], 600);
    EXPECT_EQ(json()["file"], path(name + ".xdf"));
  };
  simulate("a", "4");
  simulate("b", "4");
  simulate("c", "5");

  EXPECT_TRUE(are_same(scans_of(path("a.xdf")), scans_of(path("b.xdf"))));
  EXPECT_FALSE(are_same(scans_of(path("a.xdf")), scans_of(path("c.xdf"))));
  EXPECT_EQ(content("a.csv"), content("b.csv"));
  EXPECT_NE(content("a.csv"), content("c.csv"));
  EXPECT_THAT(content("a.csv"), StartsWith("t_s,true_ml_mm,true_ap_mm,true_load_n\n0.0,,,0.0\n0.01,"));
  EXPECT_EQ(std::ranges::count(content("a.csv"), '\n'), 601);
}

TEST_F(RunTest, SimulateWhatIsThereOrCannotBe_IsRefused) {
  const std::string there = write("there.xdf", "somebody's");
  const std::string rig = std::string(DTS_SOURCE_DIR) + "/config/rigs/floor16-sim.toml";
  for (const auto& [kind, option, value, says] :
       {std::tuple("chair", "--rig", rig, ("dtslab: " + rig + " is a rig of the kind floor\n  try: dtslab simulate floor\n")),
        {"table", "--seed", "1", "dtslab: simulate: KIND: table not in {floor,chair}\n  try: dtslab simulate --help\n"},
        {"floor", "--duration", "0",
         "dtslab: simulate: --duration: '0' is not a number of seconds from 0.1 to 86400\n  try: dtslab simulate --help\n"},
        {"floor", "--seed", "-1",
         "dtslab: simulate: --seed: '-1' is not a whole number from 0 to 4294967295\n  try: dtslab simulate --help\n"},
        {"floor", "--rate", "0", "dtslab: simulate: --rate: '0' is not a number of hertz from 1 to 20000\n  try: dtslab simulate --help\n"},
        {"floor", "--out", there, "dtslab: " + there + " exists already\n  try: choose another name: dtsd never overwrites a recording\n"},
        {"chair", "--out", there,
         "dtslab: " + there + " exists already\n  try: choose another name: dtsd never overwrites a recording\n"}}) {
    std::vector<std::string> words{"simulate", kind, option, value};
    if (option != std::string("--duration")) words.insert(words.end(), {"--duration", "1"});
    if (option != std::string("--out")) words.insert(words.end(), {"--out", path("c.xdf")});
    EXPECT_NE(run_with(words), cli::kOk);
    EXPECT_EQ(talk(), says);
  }
  EXPECT_FALSE(std::filesystem::exists(path("c.xdf")));
}

TEST_F(RunTest, SimulateThatCannotBegin_LeavesNoTruthWithoutARecordingAndNoRecordingWithoutItsTruth) {
  write("there.xdf", "somebody's");

  EXPECT_NE(run_with({"simulate", "floor", "--duration", "1", "--out", path("there.xdf"), "--truth", path("truth.csv")}), cli::kOk);
  EXPECT_FALSE(std::filesystem::exists(path("truth.csv")));

  EXPECT_EQ(run_with({"simulate", "floor", "--duration", "1", "--out", path("b.xdf"), "--truth", path("none/truth.csv")}), cli::kFailed);
  EXPECT_THAT(talk(), HasSubstr("truth.csv"));
  EXPECT_FALSE(std::filesystem::exists(path("b.xdf")));
  EXPECT_FALSE(std::filesystem::exists(path("b.xdf.part")));
}

TEST_F(RunTest, SimulateARigFile_RecordsItsDefinition) {
  const std::string rig = std::string(DTS_SOURCE_DIR) + "/config/rigs/floor16-sim.toml";

  ASSERT_EQ(run_with({"simulate", "floor", "--duration", "2", "--rig", rig, "--out", path("a.xdf")}), cli::kOk) << talk();

  const auto recording = record::Recording::open(path("a.xdf")).value();
  EXPECT_EQ(recording->session()->rig_definition, files::rig_definition(rig).value());
  EXPECT_EQ(recording->streams()[recording->find_stream("raw").value()].channels.size(), 16U);
  EXPECT_EQ(run_with({"replay", path("a.xdf")}), cli::kOk) << talk();
}

TEST_F(RunTest, SimulateTheChair_RecordsReachesAndTheirTruth) {
  ASSERT_EQ(
      run_with({"simulate", "chair", "--duration", "45", "--rate", "100", "--seed", "3", "--out", path("a.xdf"), "--truth", path("a.csv")}),
      cli::kOk)
      << talk();

  const auto recording = record::Recording::open(path("a.xdf")).value();
  EXPECT_EQ(recording->streams()[recording->find_stream("raw").value()].channels.size(), 16U);
  EXPECT_TRUE(recording->find_stream("transient").has_value());
  const std::string truth = content("a.csv");
  EXPECT_THAT(truth, StartsWith("number,condition,target_cm,t_on_s,t_hit_s,t_back_s,t_end_s,trunk_deg\n1,80,"));
  EXPECT_THAT(truth, HasSubstr("\n5,max,125"));
  EXPECT_EQ(run_with({"replay", path("a.xdf")}), cli::kOk) << talk();
}

TEST_F(RunTest, SimulateTheChairForASecond_HasNoReachToTellOf) {
  ASSERT_EQ(run_with({"simulate", "chair", "--duration", "1", "--out", path("a.xdf"), "--truth", path("a.csv")}), cli::kOk) << talk();

  EXPECT_EQ(content("a.csv"), "number,condition,target_cm,t_on_s,t_hit_s,t_back_s,t_end_s,trunk_deg\n");
}

TEST_F(RunTest, CompareARecordingWithItsTruth_FindsTheFilterDelayAccountedFor) {
  RecordProperty("requirement", "SIG-3");
  ASSERT_EQ(run_with({"simulate", "floor", "--duration", "40", "--out", path("a.xdf"), "--truth", path("truth.csv")}), cli::kOk) << talk();
  std::string truth = content("truth.csv");
  truth.replace(0, truth.find('\n'), "t_s,x_mm,y_mm,load_n");
  write("b.csv", truth);

  ASSERT_EQ(run_with({"compare", path("a.xdf"), path("b.csv"), "--json"}), cli::kOk) << talk();

  EXPECT_EQ(json()["alignment"]["by"], "correlation");
  EXPECT_LT(json()["rmse_total_mean_removed_mm"], 3.0);
  // The stamps of the file begin at 1 s; 10 ms more would be the delay of the window.
  EXPECT_NEAR(json()["alignment"]["offset_s"], 1.0, 0.005);
}

TEST_F(RunTest, CompareARecordingWithoutCop_IsAProblem) {
  write("none.xdf", "no XDF");

  EXPECT_EQ(run_with({"compare", path("none.xdf"), path("none.xdf")}), cli::kUsage);
}

TEST(Definitions, OfTheDefaultAndTheConfiguredRigs_AreTheThesissPlatformAndTheChair) {
  files::Problems problems;
  const std::vector<std::tuple<pipeline::RigConfig, std::string, double, physics::RigModel>> rigs{
      {files::read_rig_text(floor_definition(200.0), "default", problems), "floor", 200.0, thesis_setup::floor_platform()},
      {files::read_rig_text(chair_definition(1500.0), "default", problems), "chair", 1500.0, sim::chair_rig()},
      {files::read_rig_file(std::string(DTS_SOURCE_DIR) + "/config/rigs/chair-sim.toml", problems), "chair", 1500.0, sim::chair_rig()}};
  EXPECT_TRUE(problems.empty()) << files::to_string(problems.front());
  for (const auto& [config, kind, rate_hz, wanted] : rigs) {
    SCOPED_TRACE(kind);
    const auto& [plate, support, sensors, transient, force_plate] = config.model;
    EXPECT_EQ(config.kind, kind);
    EXPECT_EQ(config.rate.hz(), rate_hz);
    EXPECT_FALSE(force_plate);
    EXPECT_EQ(std::tie(plate.a, plate.b, plate.h, plate.e_pa, plate.nu),
              std::tie(wanted.plate.a, wanted.plate.b, wanted.plate.h, wanted.plate.e_pa, wanted.plate.nu));
    EXPECT_EQ(support.kind, wanted.support.kind);
    EXPECT_EQ(support.inset, wanted.support.inset);
    ASSERT_EQ(transient.has_value(), wanted.transient_sensors.has_value());
    if (transient) {
      EXPECT_EQ(std::tie(transient->rear, transient->front), std::tie(wanted.transient_sensors->rear, wanted.transient_sensors->front));
    }
    ASSERT_EQ(sensors.size(), wanted.sensors.size());
    for (std::size_t s = 0; s < sensors.size(); ++s) {
      EXPECT_EQ(std::tie(sensors[s].label, sensors[s].position, sensors[s].unloaded_gap),
                std::tie(wanted.sensors[s].label, wanted.sensors[s].position, wanted.sensors[s].unloaded_gap));
      for (double gap_mm = 0.5; gap_mm <= 13.0; gap_mm += 0.1) {
        EXPECT_NEAR(sensors[s].curve.volts({gap_mm}).value, wanted.sensors[s].curve.volts({gap_mm}).value, 1e-5);
      }
    }
  }
}

}  // namespace
}  // namespace dts::lab::simulate
