// SPDX-License-Identifier: Apache-2.0
// The commands as far as they go without a daemon; with one: tests/system/calibrate_test.cpp.
#include <fstream>

#include "ctl/calibrate/gap_table.h"
#include "files/sensor_curve_file.h"
#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

using ::testing::HasSubstr;

class CalibrateCommandTest : public RunTest {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return directory_.path() / name; }
  /// Runs the offline command on a table.
  int calibrate(const std::string& rows, std::vector<std::string> further = {}) {
    std::ofstream(path("points.csv")) << rows;
    std::vector<std::string> words{"calibrate", "sensor", "--sensor", "it's", "--points", path("points.csv"), "--out", path("w1.toml")};
    words.insert(words.end(), further.begin(), further.end());
    return run_bare(words);
  }
};

// plate-model section 5: V = 0.9 + 0.35 z + 0.058 z^2, z = 12 mm - gap.
constexpr const char* kGood = "gap_mm,volts\n12,0.9\n11,1.308\n10,1.832\n9,2.472\n8,3.228\n7,4.1\n";

TEST_F(CalibrateCommandTest, Table_BecomesACurveFile) {
  ASSERT_EQ(calibrate(kGood), cli::kOk) << talk();

  EXPECT_THAT(out(), HasSubstr("curve = '" + path("w1.toml") + "'"));
  files::Problems problems;
  const auto file = files::read_sensor_curve(path("w1.toml"), problems);
  ASSERT_TRUE(file) << files::to_string(problems.at(0));
  EXPECT_EQ(file->curve.volts({12.0}).value, 0.9);
  EXPECT_EQ(file->curve.volts({7.0}).value, 4.1);
  EXPECT_THAT(out(), HasSubstr("label = \"it's\":"));
  EXPECT_EQ(file->calibration->sensor, "it's");
  EXPECT_EQ(file->calibration->daq_model, "");  // nobody knows what measured it
}

TEST_F(CalibrateCommandTest, Json_IsOneDocument) {
  ASSERT_EQ(calibrate(kGood, {"--json"}), cli::kOk) << talk();

  const auto sensor = json()["sensors"][0];
  EXPECT_EQ(sensor["sensor"], "it's");
  EXPECT_EQ(sensor["points"].size(), 6U);
  EXPECT_EQ(sensor["points"][0]["gap_mm"], 7.0);
  EXPECT_FALSE(sensor.contains("daq_model"));
  EXPECT_FALSE(sensor.contains("repeat_mv"));
}

TEST_F(CalibrateCommandTest, OffendingRow_NamedByItsLineAndNothingWritten) {
  EXPECT_EQ(calibrate("gap_mm,volts\n12,0.9\n11,1.308\n10,1.832\n9,3.228\n8,3.228\n7,4.1\n"), cli::kUsage);

  EXPECT_THAT(talk(), HasSubstr("sensor it's: row 5 (gap 9 mm, 3.2280 V)"));
  EXPECT_THAT(talk(), HasSubstr("expected"));
  EXPECT_FALSE(std::filesystem::exists(path("w1.toml")));
}

TEST_F(CalibrateCommandTest, BadTable_RefusedWithLineAndColumn) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"gap,v\n1,2\n", ":1:1: the header"},
      {"", "different gaps"},
      {"gap_mm,volts\nx,1\n", ":2:1: gap_mm"},
      {"gap_mm,volts\n12,nan\n", ":2:4: volts"},
      {"gap_mm,volts\n1000.1,1\n", ":2:1: gap_mm"},
      {"gap_mm,volts\n12,-100.1\n", ":2:4: volts"},
      {"gap_mm,volts\n12\n", ":2:4: volts"},
      {"gap_mm,volts\n12,1,5\n", ":2:4: volts"},
      {"gap_mm,volts\n-1,1\n", ":2:1: gap_mm must be a number; allowed: 0 .. 1000"}};
  for (const auto& [rows, says] : cases) {
    EXPECT_EQ(calibrate(rows), cli::kUsage) << rows;
    EXPECT_THAT(talk(), HasSubstr(says)) << rows;
  }
}

TEST_F(CalibrateCommandTest, TableAtItsLimits_IsRead) {
  std::ofstream(path("points.csv")) << "gap_mm,volts\r\n0,-100\r\n1000,100\n";

  const auto readings = read_gap_table(path("points.csv"));

  ASSERT_TRUE(readings) << readings.error().what;
  EXPECT_EQ(readings->at(0).volts.value, -100.0);
  EXPECT_EQ(readings->at(1).gap.value, 1000.0);
  EXPECT_EQ(readings->at(1).row, 3U);
}

TEST_F(CalibrateCommandTest, ExistingFile_IsNotOverwritten) {
  std::ofstream(path("w1.toml")) << "precious";

  EXPECT_EQ(calibrate(kGood), cli::kUsage);

  EXPECT_THAT(talk(), HasSubstr("exists already"));
  std::string content;
  std::ifstream(path("w1.toml")) >> content;
  EXPECT_EQ(content, "precious");
}

TEST_F(CalibrateCommandTest, WrongUsage_SaysWhatIsMissing) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"calibrate", "sensor"}, "--sensor is required"},
      {{"calibrate", "sensor", "--sensor", "w1"}, "measuring needs a rig"},
      {{"calibrate", "sensor", "--rig", "r", "--sensor", "w1", "--gaps", "12,nan"}, "not a number of mm"},
      {{"calibrate", "sensor", "--rig", "r", "--sensor", "w1", "--gaps", "12,11,10,11,12"}, "3 different gaps, at least 5"},
      {{"calibrate", "sensor", "--sensor", "../w1", "--points", "p.csv"}, "is no label of a sensor"},
      {{"calibrate", "sensor", "--sensor", "w1", "--points", "nowhere.csv"}, "nowhere.csv: no such file"},
      {{"calibrate", "sensor", "--sensor", "w1", "--points", "p.csv", "--out", "/nowhere/w1.toml"}, "there is no folder /nowhere"},
      {{"calibrate", "cop"}, "--rig is required"},
      {{"calibrate", "cop", "--rig", "r", "--estimator", "best"}, "poly3"},
      {{"calibrate", "cop", "--rig", "r", "--grid", "3"}, "4"},
      {{"calibrate", "cop", "--rig", "r", "--resume", "--fresh"}, "--fresh"},
      {{"calibrate", "cop", "--rig", "r", "--hold", "0"}, "from 0.02 to 600"}};
  for (const auto& [words, says] : cases) {
    EXPECT_EQ(run_bare(words), cli::kUsage) << ::testing::PrintToString(words);
    EXPECT_THAT(talk(), HasSubstr(says)) << ::testing::PrintToString(words);
  }
}

}  // namespace
}  // namespace dts::ctl
