// SPDX-License-Identifier: Apache-2.0
#include "files/sensor_curve_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "files/whole_file.h"

namespace dts::files {
namespace {

class SensorCurveFiles : public testing::Test {
 protected:
  SensorCurveFiles() {
    std::string pattern = testing::TempDir() + "dts-curve-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
  }
  ~SensorCurveFiles() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] std::string write(const std::string& text) const {
    std::ofstream(path("curve.toml")) << text;
    return path("curve.toml");
  }
  /// All problems of a text, without the folder.
  [[nodiscard]] std::string problems_of(const std::string& text) const {
    Problems problems;
    const auto file = read_sensor_curve(write(text), problems);
    EXPECT_EQ(file.has_value(), problems.empty());
    std::string all;
    for (const Problem& problem : problems) all += to_string(problem).substr(folder_.string().size() + 1) + "\n";
    return all;
  }

  std::filesystem::path folder_;
};

const std::vector<physics::CurvePoint> kPoints{
    {.gap = {7.1}, .volts = {4.0 / 3.0}}, {.gap = {9.0}, .volts = {1.0}}, {.gap = {12.0}, .volts = {0.1}}};

SensorCalibrationFacts facts() {
  return {.created_utc = "2026-01-31T12:00:00Z",
          .rig = "floor",
          .sensor = "w1",
          .daq_model = "USB-6008 \"lab\"",
          .daq_serial = "01A2",
          .channel = "ai0",
          .range_v = 5.0,
          .residual_mv = 1.0 / 3.0,
          .repeat_mv = 0.25,
          .readings_per_gap = 2,
          .samples_per_point = 300};
}

TEST_F(SensorCurveFiles, Written_ReadsBackExactly) {
  const auto written = with_id(facts(), kPoints);
  ASSERT_TRUE(write_sensor_curve(path("w1.toml"), "floor-w1", kPoints, written));

  Problems problems;
  const auto read = read_sensor_curve(path("w1.toml"), problems);

  ASSERT_TRUE(read) << to_string(problems.at(0));
  EXPECT_EQ(read->curve.name(), "floor-w1");
  EXPECT_EQ(read->curve.minimum_gap().value, 7.1);
  EXPECT_EQ(read->curve.maximum_gap().value, 12.0);
  EXPECT_EQ(read->curve.volts({7.1}).value, 4.0 / 3.0);
  ASSERT_TRUE(read->calibration);
  EXPECT_EQ(read->calibration->id, written.id);
  EXPECT_EQ(read->calibration->created_utc, "2026-01-31T12:00:00Z");
  EXPECT_EQ(read->calibration->rig, "floor");
  EXPECT_EQ(read->calibration->sensor, "w1");
  EXPECT_EQ(read->calibration->daq_model, "USB-6008 \"lab\"");
  EXPECT_EQ(read->calibration->daq_serial, "01A2");
  EXPECT_EQ(read->calibration->channel, "ai0");
  EXPECT_EQ(read->calibration->range_v, 5.0);
  EXPECT_EQ(read->calibration->residual_mv, 1.0 / 3.0);
  EXPECT_EQ(read->calibration->repeat_mv, 0.25);
  EXPECT_EQ(read->calibration->readings_per_gap, 2U);
  EXPECT_EQ(read->calibration->samples_per_point, 300U);
}

TEST_F(SensorCurveFiles, Id_NamesTheDateAndChangesWithThePoints) {
  const std::string id = with_id(facts(), kPoints).id;
  auto others = kPoints;
  others[1].volts.value += 1e-12;

  EXPECT_EQ(id.rfind("sensor-20260131T120000Z-", 0), 0U) << id;
  EXPECT_EQ(id.size(), std::string("sensor-20260131T120000Z-01234567").size());
  EXPECT_NE(id, with_id(facts(), others).id);
}

TEST_F(SensorCurveFiles, UnknownFacts_AreAbsent) {
  const std::string text = sensor_curve_text("bench", kPoints, {.created_utc = "2026-01-31T12:00:00Z"});

  for (const char* key : {"daq_model", "daq_serial", "channel", "range_v", "repeat_mv =", "rig ="}) {
    EXPECT_EQ(text.find(key, text.find("[calibration]")), std::string::npos) << key;
  }
  EXPECT_EQ(problems_of(text), "");
}

TEST_F(SensorCurveFiles, ShippedFile_HasNoCalibration) {
  Problems problems;

  const auto file = read_sensor_curve(std::string(DTS_SOURCE_DIR) + "/config/sensors/hoa1405-assumed.toml", problems);

  ASSERT_TRUE(file) << to_string(problems.at(0));
  EXPECT_FALSE(file->calibration.has_value());
}

TEST_F(SensorCurveFiles, WrongValues_ReportedWithLineAndRange) {
  EXPECT_EQ(problems_of("[[point]]\ngap_mm = 7\nvolts = 101.0\n").substr(0, 12), "curve.toml:1");  // the name is missing
  EXPECT_NE(
      problems_of("name = \"a\"\n[[point]]\ngap_mm = 7\nvolts = 101.0\n").find("curve.toml:4:9: [[point]] volts = 101 is out of range"),
      std::string::npos);
  EXPECT_NE(problems_of("name = \"a\"\n[calibration]\nsamples_per_point = 0\n[[point]]\ngap_mm = 7\nvolts = 1.0\n")
                .find("curve.toml:3:21: [calibration] samples_per_point = 0 is out of range"),
            std::string::npos);
  EXPECT_NE(problems_of("name = \"a\"\n[calibration]\nresidual_mv = nan\n").find("curve.toml:3:15: "), std::string::npos);
  EXPECT_NE(problems_of("name = \"a\"\n[calibration]\nserial = \"x\"\n").find("unknown key 'serial'"), std::string::npos);
}

TEST_F(SensorCurveFiles, VoltsThatTurnBack_RefusedNamingThePoint) {
  const std::string two = "name = \"a\"\n[[point]]\ngap_mm = 0.0\nvolts = 3\n[[point]]\ngap_mm = 8\nvolts = 2\n";
  const std::string what = problems_of(two + "[[point]]\ngap_mm = 9\nvolts = 2.5\n");

  EXPECT_NE(what.find("point 2 (9 mm, 2.5 V)"), std::string::npos) << what;
  EXPECT_EQ(problems_of(two + "[[point]]\ngap_mm = 9\nvolts = 1.5\n"), "");
}

TEST_F(SensorCurveFiles, WholeFileThatCannotReplace_LeavesTheOldAndNothingBeside) {
  std::filesystem::create_directories(path("a.txt/inside"));  // a folder that is not empty cannot be renamed over

  const auto status = write_whole_file(path("a.txt"), "new");

  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find(path("a.txt")), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists(path("a.txt/inside")));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

}  // namespace
}  // namespace dts::files
