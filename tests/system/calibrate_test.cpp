// SPDX-License-Identifier: Apache-2.0
// Calibration as a user does it, with the real daemon and a simulated assistant who puts the weights down.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "files/cop_calibration_file.h"
#include "files/sensor_curve_file.h"
#include "system/daemon_process.h"

namespace dts::test {
namespace {

using nlohmann::json;

struct Weight {
  double x_mm = 0.0;  ///< From the centre.
  double y_mm = 0.0;
  double load_n = 0.0;
};

constexpr double kHalfMm = 129.0;  // the sensors of the shipped platform lie so far from the centre, along both axes

/// One filtered scan at 490 N errs by 0.31 mm rms (plate-model section 6); a hold of 80 scans has 26 independent ones.
const double kFiveDeviationsMm = 5.0 * 0.31 / std::sqrt(26.0);

/// The ten places of thesis 4.4, in the order in which the guide asks for them.
std::vector<Weight> mid_lines(double load_n) {
  std::vector<Weight> weights;
  for (int k = -2; k <= 2; ++k) weights.push_back({k * kHalfMm / 2.0, 0.0, load_n});
  for (int k = -2; k <= 2; ++k) weights.push_back({0.0, k * kHalfMm / 2.0, load_n});
  return weights;
}

void prepend(const std::filesystem::path& path, const std::string& text) {
  std::stringstream content;
  content << text << std::ifstream(path).rdbuf();
  std::ofstream(path) << content.str();
}

/// Files of one test: the weights, the progress and what is written.
class CalibrateTest : public ::testing::Test {
 protected:
  CalibrateTest() {
    std::string pattern = ::testing::TempDir() + "dts-cal-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
    ::setenv("XDG_STATE_HOME", (folder_ / "state").c_str(), 1);
  }
  ~CalibrateTest() override {
    ::unsetenv("XDG_STATE_HOME");
    std::filesystem::remove_all(folder_);
  }

  /// A platform at 1000 Hz on which the weights are placed in turn, after time for a tare.
  [[nodiscard]] DaemonProcess::Options placing(const std::vector<Weight>& weights) const {
    const std::string file = folder_ / ("weights" + std::to_string(weights.size()) + ".csv");
    std::ofstream stream(file);
    stream << "x_mm,y_mm,load_n\n";
    for (const Weight& weight : weights) stream << weight.x_mm << ',' << weight.y_mm << ',' << weight.load_n << '\n';
    return simulated("contact=weights&weights=" + file + "&step_on_s=6&hold_s=0.14&pause_s=0.02&ramp_s=0.02");
  }
  [[nodiscard]] static DaemonProcess::Options simulated(const std::string& options) {
    return {.device = "sim:floor?seed=3&bits=16&" + options,
            .acquire = "rate_hz = 1000.0",
            .stages =
                "[[stage]]\nid = \"guard\"\n[[stage]]\nid = \"window_filter\"\n[[stage]]\nid = \"linearise\"\ntare_ms = 200.0\n"
                "[[stage]]\nid = \"cop\"\n",
            .daemon = {},
            .further_rigs = {}};
  }
  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] std::vector<std::string> cop(const std::vector<std::string>& further) const {
    std::vector<std::string> words{"calibrate", "cop", "--rig", "floor", "--auto", "--hold", "0.08", "--json", "--out", path("cop.toml")};
    words.insert(words.end(), further.begin(), further.end());
    return words;
  }
  [[nodiscard]] std::string progress_file() const { return path("state/dts/calibrate-cop-floor.jsonl"); }

  std::filesystem::path folder_;
};

TEST_F(CalibrateTest, CopByTheThesis_WritesAFileThatMeetsItsPointsAndTheDaemonTakes) {
  RecordProperty("requirement", "COP-10");
  auto weights = mid_lines(490.0);
  weights.push_back({-kHalfMm, -kHalfMm, 490.0});  // first and last point of Table 4.1
  weights.push_back({0.0, 0.0, 490.0});
  DaemonProcess daemon(placing(weights));
  ASSERT_TRUE(daemon.is_ready()) << daemon.log();

  const Finished finished = daemon.ctl(cop({"--estimator", "thesis", "--verify", "2"}));

  ASSERT_EQ(finished.status, 0) << finished.err;
  const json report = json::parse(finished.out);
  EXPECT_EQ(report["estimator"], "thesis");
  EXPECT_EQ(report["points"].size(), 10U);
  EXPECT_EQ(report["daq_model"], "Simulated floor platform");
  EXPECT_EQ(report["daq_serial"], "sim-floor-3");
  EXPECT_LT(report["residuals"]["max_total_mm"].get<double>(), kFiveDeviationsMm);  // what is left is the centre, measured twice
  const json& centre = report["verification"]["points"][1];
  EXPECT_EQ(centre["x_mm"], 215.0);
  EXPECT_LT(std::hypot(centre["x_error_mm"].get<double>(), centre["y_error_mm"].get<double>()), std::sqrt(2.0) * kFiveDeviationsMm);
  files::Problems problems;
  const auto file = files::read_cop_calibration(path("cop.toml"), problems);
  ASSERT_TRUE(file) << files::to_string(problems.at(0));
  EXPECT_EQ(file->id, report["id"].get<std::string>());
  EXPECT_EQ(file->estimator.method(), physics::CopMethod::Thesis);
  EXPECT_FALSE(std::filesystem::exists(progress_file())) << "a finished calibration leaves no progress behind";

  daemon.signal(SIGTERM);
  ASSERT_EQ(daemon.wait(), 0);
  prepend(daemon.directory() / "rigs" / "floor.toml", report["rig_file_line"].get<std::string>() + "\n");
  daemon.restart();
  EXPECT_TRUE(daemon.is_ready()) << daemon.log();
  EXPECT_EQ(json::parse(daemon.ctl({"rig", "show", "floor", "--json"}).out).at("rig").at("calibration"), report["id"]);
}

TEST_F(CalibrateTest, KilledInTheMiddle_ResumesWhereItWas) {
  RecordProperty("requirement", "COP-10");
  const auto weights = mid_lines(490.0);
  {
    const DaemonProcess daemon(placing({weights.begin(), weights.begin() + 4}));
    ASSERT_TRUE(daemon.is_ready()) << daemon.log();
    std::string line = DTSCTL_PROGRAM;
    for (const std::string& word : cop({"--estimator", "thesis", "--verify", "0"})) line += " " + word;
    const std::string until =
        "until [ \"$(wc -l < " + progress_file() + ")\" -ge 5 ]; do sleep 0.02; done 2>/dev/null; ";  // head and 4 points
    const Finished killed =
        run_program({"/bin/sh", "-c", line + " & " + until + "kill -9 $!; wait $!"}, {"DTSD_RUNTIME_DIR=" + daemon.directory().string()});
    ASSERT_EQ(killed.status, 137) << killed.err;
  }
  std::ofstream(progress_file(), std::ios::app) << "{\"index\": 4, \"mean\": [1.0, 2";  // the crash was in the middle of a line
  const DaemonProcess daemon(placing({weights.begin() + 4, weights.end()}));
  ASSERT_TRUE(daemon.is_ready()) << daemon.log();

  const Finished undecided = daemon.ctl(cop({"--estimator", "thesis", "--verify", "0"}));
  const Finished other = daemon.ctl(cop({"--estimator", "poly3", "--resume"}));
  const Finished resumed = daemon.ctl(cop({"--resume"}));  // estimator and verification as they were begun

  EXPECT_EQ(undecided.status, 6);
  EXPECT_THAT(undecided.err, ::testing::HasSubstr("--resume"));
  EXPECT_EQ(other.status, 6);
  EXPECT_THAT(other.err, ::testing::HasSubstr("estimator was \"thesis\""));
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_THAT(resumed.err, ::testing::HasSubstr("Point 5 of 10"));
  EXPECT_THAT(resumed.err, ::testing::Not(::testing::HasSubstr("Point 4 of 10")));
  EXPECT_LT(json::parse(resumed.out)["residuals"]["max_total_mm"].get<double>(), kFiveDeviationsMm);
}

TEST_F(CalibrateTest, CopOnALoadedPlate_RefusedBeforeAnyPoint) {
  const DaemonProcess daemon(simulated("step_on_s=0"));
  ASSERT_TRUE(eventually([&] { return daemon.control().status().value().rigs(0).scans_total() > 3000; }));  // both feet are there

  const Finished finished = daemon.ctl(cop({"--estimator", "thesis"}));

  EXPECT_EQ(finished.status, 6) << finished.err;
  EXPECT_FALSE(std::filesystem::exists(path("cop.toml")));
}

TEST_F(CalibrateTest, Sensors_GiveBackTheirCurve) {
  const DaemonProcess daemon(
      simulated("contact=gaps&gaps_mm=12.5,12,11,10,9,8,7,6.5&step_on_s=5&hold_s=0.5&pause_s=0.3&ramp_s=0.05&range_v=10"));
  ASSERT_TRUE(daemon.is_ready()) << daemon.log();

  const Finished finished = daemon.ctl(
      {"calibrate", "sensor", "--rig", "floor", "--sensor", "all", "--auto", "--hold", "0.2", "--json", "--out", folder_.string()});

  ASSERT_EQ(finished.status, 0) << finished.err;
  const json report = json::parse(finished.out);
  ASSERT_EQ(report["sensors"].size(), 4U);
  const physics::SensorCurve assumed = physics::SensorCurve::hoa1405_assumed();
  for (const json& sensor : report["sensors"]) {
    EXPECT_EQ(sensor["daq_serial"], "sim-floor-3");
    ASSERT_EQ(sensor["points"].size(), 8U);
    for (const json& point : sensor["points"]) {
      const double expected_v = assumed.volts({point["gap_mm"].get<double>()}).value;
      EXPECT_NEAR(point["volts"].get<double>(), expected_v, 5.0 * 0.003 / std::sqrt(200.0)) << point;  // 3 mV white noise, 200 scans
    }
    files::Problems problems;
    const auto file = files::read_sensor_curve(sensor["file"].get<std::string>(), problems);
    ASSERT_TRUE(file) << files::to_string(problems.at(0));
    EXPECT_EQ(file->calibration->id, sensor["id"].get<std::string>());
    EXPECT_EQ(file->calibration->origin.channel, sensor["channel"].get<std::string>());
    EXPECT_EQ(file->calibration->samples_per_point, 200U);
    EXPECT_EQ(file->calibration->range_v, 10.0);
    EXPECT_GT(sensor["points"].back()["gap_mm"], 12.0) << "the curve must reach beyond the unloaded gap";
  }
  EXPECT_THAT(finished.err, ::testing::Not(::testing::HasSubstr("warning")));
}

TEST_F(CalibrateTest, RefusedSensor_LeavesItsReadingsToBeMended) {
  // The third spacer was mistaken for the second.
  const DaemonProcess daemon(simulated("contact=gaps&gaps_mm=12,10,11,9,8,7&step_on_s=5&hold_s=0.5&pause_s=0.3&ramp_s=0.05&range_v=10"));
  ASSERT_TRUE(daemon.is_ready()) << daemon.log();

  const Finished refused = daemon.ctl({"calibrate", "sensor", "--rig", "floor", "--sensor", "w1", "--auto", "--hold", "0.2", "--gaps",
                                       "12,11,10,9,8,7", "--json", "--out", path("w1.toml")});

  EXPECT_EQ(refused.status, 2) << refused.err;
  EXPECT_EQ(json::parse(refused.out)["error"]["code"], "invalid_argument");
  EXPECT_THAT(refused.err, ::testing::HasSubstr(path("w1.toml.readings.csv")));
  std::ifstream file(path("w1.toml.readings.csv"));
  std::vector<std::string> rows;
  for (std::string row; std::getline(file, row);) rows.push_back(row);
  ASSERT_EQ(rows.size(), 7U);
  EXPECT_EQ(rows[0], "gap_mm,volts");
  rows[2].replace(0, 2, "10");
  rows[3].replace(0, 2, "11");
  std::ofstream mended(path("mended.csv"));
  for (const std::string& row : rows) mended << row << '\n';
  mended.close();

  const Finished finished = daemon.ctl({"calibrate", "sensor", "--sensor", "w1", "--points", path("mended.csv"), "--out", path("w1.toml")});
  EXPECT_EQ(finished.status, 0) << finished.err;
}

}  // namespace
}  // namespace dts::test
