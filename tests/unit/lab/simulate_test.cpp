// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "files/rig_file.h"
#include "lab/recording.h"
#include "lab/simulated_rig.h"
#include "lab/thesis_setup.h"
#include "physics/body/chair_rig.h"
#include "record/recording.h"
#include "unit/lab/run_fixture.h"

namespace dts::lab {
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

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
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
  EXPECT_EQ(text_of(path("a.csv")), text_of(path("b.csv")));
  EXPECT_NE(text_of(path("a.csv")), text_of(path("c.csv")));
  EXPECT_THAT(text_of(path("a.csv")), StartsWith("t_s,true_ml_mm,true_ap_mm,true_load_n\n0.0,,,0.0\n0.01,"));
  EXPECT_EQ(std::ranges::count(text_of(path("a.csv")), '\n'), 601);
}

TEST_F(RunTest, SimulateWhatIsThereOrCannotBe_IsRefused) {
  ASSERT_EQ(run_with({"simulate", "floor", "--duration", "1", "--out", path("a.xdf")}), cli::kOk) << talk();

  EXPECT_NE(run_with({"simulate", "floor", "--duration", "1", "--out", path("a.xdf")}), cli::kOk) << "it exists";
  EXPECT_NE(run_with({"simulate", "chair", "--duration", "1", "--out", path("a.xdf")}), cli::kOk) << "it exists";
  const std::string rig = std::string(DTS_SOURCE_DIR) + "/config/rigs/floor16-sim.toml";
  EXPECT_NE(run_with({"simulate", "chair", "--duration", "1", "--rig", rig, "--out", path("c.xdf")}), cli::kOk) << "no chair";
  EXPECT_THAT(talk(), HasSubstr("of the kind floor"));
  EXPECT_EQ(run_with({"simulate", "table", "--duration", "1", "--out", path("c.xdf")}), cli::kUsage);
  EXPECT_EQ(run_with({"simulate", "floor", "--duration", "0", "--out", path("c.xdf")}), cli::kUsage);
  EXPECT_EQ(run_with({"simulate", "floor", "--duration", "1", "--seed", "-1", "--out", path("c.xdf")}), cli::kUsage);
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
  const std::string truth = text_of(path("a.csv"));
  EXPECT_THAT(truth, StartsWith("number,condition,target_cm,t_on_s,t_hit_s,t_back_s,t_end_s,trunk_deg\n1,80,"));
  EXPECT_THAT(truth, HasSubstr("\n5,max,125"));
  EXPECT_EQ(run_with({"replay", path("a.xdf")}), cli::kOk) << talk();
}

TEST_F(RunTest, SimulateTheChairForASecond_HasNoReachToTellOf) {
  ASSERT_EQ(run_with({"simulate", "chair", "--duration", "1", "--out", path("a.xdf"), "--truth", path("a.csv")}), cli::kOk) << talk();

  EXPECT_EQ(text_of(path("a.csv")), "number,condition,target_cm,t_on_s,t_hit_s,t_back_s,t_end_s,trunk_deg\n");
}

TEST_F(RunTest, CompareARecordingWithItsTruth_FindsTheFilterDelayAccountedFor) {
  ASSERT_EQ(run_with({"simulate", "floor", "--duration", "40", "--out", path("a.xdf"), "--truth", path("truth.csv")}), cli::kOk) << talk();
  std::string truth = text_of(path("truth.csv"));
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

TEST(FloorDefinition, OfTheDefaultRig_IsTheThesissPlatform) {
  files::Problems problems;

  const auto config = files::read_rig_text(floor_definition(200.0), "default", problems);

  EXPECT_TRUE(problems.empty()) << files::to_string(problems.front());
  const physics::RigModel thesis = thesis_setup::floor_platform();
  EXPECT_EQ(config.rate.hz(), 200.0);
  EXPECT_EQ(config.model.plate.e_pa, thesis.plate.e_pa);
  ASSERT_EQ(config.model.sensors.size(), thesis.sensors.size());
  for (std::size_t s = 0; s < thesis.sensors.size(); ++s) {
    EXPECT_EQ(config.model.sensors[s].position.x, thesis.sensors[s].position.x);
    for (double gap_mm = 4.0; gap_mm <= 13.0; gap_mm += 0.1) {
      EXPECT_NEAR(config.model.sensors[s].curve.volts({gap_mm}).value, thesis.sensors[s].curve.volts({gap_mm}).value, 1e-5);
    }
  }
}

void expect_chair(const pipeline::RigConfig& config) {
  const physics::RigModel chair = physics::chair_rig();
  EXPECT_EQ(config.kind, "chair");
  EXPECT_EQ(config.model.plate.a, chair.plate.a);
  EXPECT_EQ(config.model.plate.b, chair.plate.b);
  EXPECT_EQ(config.model.plate.h, chair.plate.h);
  EXPECT_EQ(config.model.plate.e_pa, chair.plate.e_pa);
  EXPECT_EQ(config.model.plate.nu, chair.plate.nu);
  EXPECT_EQ(config.model.support.kind, chair.support.kind);
  ASSERT_TRUE(config.model.transient_sensors.has_value());
  EXPECT_EQ(config.model.transient_sensors->rear, chair.transient_sensors->rear);
  EXPECT_EQ(config.model.transient_sensors->front, chair.transient_sensors->front);
  ASSERT_EQ(config.model.sensors.size(), chair.sensors.size());
  for (std::size_t s = 0; s < chair.sensors.size(); ++s) {
    EXPECT_EQ(config.model.sensors[s].label, chair.sensors[s].label);
    EXPECT_EQ(config.model.sensors[s].position, chair.sensors[s].position);
    EXPECT_EQ(config.model.sensors[s].unloaded_gap, chair.sensors[s].unloaded_gap);
    for (double gap_mm = 0.5; gap_mm <= 12.0; gap_mm += 0.1) {
      EXPECT_NEAR(config.model.sensors[s].curve.volts({gap_mm}).value, chair.sensors[s].curve.volts({gap_mm}).value, 1e-5);
    }
  }
}

TEST(ChairDefinition, OfTheDefaultRig_IsTheChair) {
  files::Problems problems;

  const auto config = files::read_rig_text(chair_definition(1500.0), "default", problems);

  EXPECT_TRUE(problems.empty()) << files::to_string(problems.front());
  EXPECT_EQ(config.rate.hz(), 1500.0);
  expect_chair(config);
}

TEST(ChairDefinition, OfTheConfiguredRig_IsTheSameChair) {
  files::Problems problems;

  const auto config = files::read_rig_file(std::string(DTS_SOURCE_DIR) + "/config/rigs/chair-sim.toml", problems);

  EXPECT_TRUE(problems.empty()) << files::to_string(problems.front());
  expect_chair(config);
}

}  // namespace
}  // namespace dts::lab
