// SPDX-License-Identifier: Apache-2.0
#include "files/sensor_curve_file.h"

#include <gtest/gtest.h>

#include "unit/files/files_fixture.h"

namespace dts::files {
namespace {

class SensorCurveFiles : public FilesTest {
 protected:
  static void read(const std::string& text, Problems& problems) {
    const auto table = parse_toml_text(text, "curve", problems);
    if (!table) return;
    TomlReader reader(&*table, "", "curve", problems);
    const bool is_read = read_sensor_curve(reader, problems).has_value();
    EXPECT_EQ(is_read, problems.empty());
  }
};

const std::vector<physics::CurvePoint> kPoints{
    {.gap = {7.1}, .volts = {4.0 / 3.0}}, {.gap = {9.0}, .volts = {1.0}}, {.gap = {12.0}, .volts = {0.1}}};

SensorCalibrationFacts facts() {
  return {.origin = {.created_utc = "2026-01-31T12:00:00Z",
                     .rig = "floor",
                     .sensor = "w1",
                     .daq_model = "USB-6008 \"lab\"",
                     .daq_serial = "01A2",
                     .channel = "ai0"},
          .range_v = 5.0,
          .residual_mv = 1.0 / 3.0,
          .repeat_mv = 0.25,
          .readings_per_gap = 2,
          .samples_per_point = 300};
}

constexpr const char* kHead =
    R"(# A measured sensor curve: output voltage over the gap between sensor and plate, rising gaps.
# Between the points: monotone cubic (Fritsch-Carlson). Use it in a rig file: [[sensor]] curve = "this file"
# residual_mv: rms of the points about a smooth curve; repeat_mv: rms of repeated readings about their mean.
)";
constexpr const char* kFacts = R"(name = 'floor-w1'

[calibration]
id = 'sensor-20260131T120000Z-2898dd44'
created_utc = '2026-01-31T12:00:00Z'
rig = 'floor'
sensor = 'w1'
daq_model = 'USB-6008 "lab"'
daq_serial = '01A2'
channel = 'ai0'
range_v = 5.0
residual_mv = 0.3333333333333333
repeat_mv = 0.25
readings_per_gap = 2
samples_per_point = 300
)";
constexpr const char* kPointsText = R"(
[[point]]
gap_mm = 7.1
volts = 1.3333333333333333

[[point]]
gap_mm = 9.0
volts = 1.0

[[point]]
gap_mm = 12.0
volts = 0.1
)";

TEST_F(SensorCurveFiles, Written_ReadsBackExactly) {
  ASSERT_TRUE(write_sensor_curve(path("w1.toml"), "floor-w1", kPoints, with_id(facts(), kPoints)));
  EXPECT_EQ(content_of(path("w1.toml")), std::string(kHead) + kFacts + kPointsText);

  Problems problems;
  const auto read = read_sensor_curve(path("w1.toml"), problems);

  ASSERT_TRUE(read) << text_of(problems);
  EXPECT_EQ(read->curve.volts({7.1}).value, 4.0 / 3.0);
  // The points as the curve gives them back: what was read is what would be written again.
  EXPECT_EQ(sensor_curve_text(read->curve.name(), kPoints, *read->calibration), content_of(path("w1.toml")));
}

TEST_F(SensorCurveFiles, UnknownFacts_AreAbsent) {
  const std::string text = sensor_curve_text("bench", kPoints, {.origin = {.created_utc = "2026-01-31T12:00:00Z"}});
  EXPECT_EQ(text, std::string(kHead) +
                      "name = 'bench'\n\n[calibration]\ncreated_utc = '2026-01-31T12:00:00Z'\nresidual_mv = 0.0\n"
                      "readings_per_gap = 1\nsamples_per_point = 1\n" +
                      kPointsText);
  expect_problems(text, {{"name", "name = \"bench\"", ""}}, read);
}

TEST_F(SensorCurveFiles, ShippedFile_HasNoCalibration) {
  Problems problems;

  const auto file = read_sensor_curve(kConfig / "sensors/hoa1405-assumed.toml", problems);

  ASSERT_TRUE(file) << text_of(problems);
  EXPECT_FALSE(file->calibration.has_value());
}

TEST_F(SensorCurveFiles, Limits_AreReportedWithPlaceAndRange) {
  expect_problems(
      std::string(kFacts) + kPointsText,
      {
          {"name", "", "curve:1:1: name is missing"},
          {"name", "nam = \"a\"",
           "curve:1:1: name is missing\n"
           "curve:1:1: unknown key 'nam'; did you mean 'name'?"},
          {"id", "serial = \"x\"", "curve:4:1: unknown key 'serial' in [calibration]"},
          {"id", "id = 3", "curve:4:6: [calibration] id must be a text in quotes"},
          {"gap_mm = 12", "gap_mm = 1000",
           "curve:1:1: sensor curve 'floor-w1' is nearly flat somewhere: gap to volts and back is off by 0.00129516 mm, above 5e-05 mm "
           "(leave out the flat end of the curve)"},
          {"gap_mm", "", "curve:17:1: [[point]] gap_mm is missing"},
          {"gap_mm", "gap_mm = 7\ngap = 7", "curve:19:1: unknown key 'gap' in [[point]]"},
          {"volts", "volts = 100.0",
           "curve:1:1: sensor curve 'floor-w1' is nearly flat somewhere: gap to volts and back is off by 5.48133e-05 mm, above 5e-05 mm "
           "(leave out the flat end of the curve)"},
          {"volts", "", "curve:17:1: [[point]] volts is missing"},
          {"volts = 0.1", "volts = -100.0",
           "curve:1:1: sensor curve 'floor-w1' is nearly flat somewhere: gap to volts and back is off by 0.000371607 mm, above 5e-05 mm "
           "(leave out the flat end of the curve)"},
          {"volts = 0.1", "volts = 1.1",
           "curve:1:1: sensor curve 'floor-w1', point 2 (12 mm, 1.1 V): the volts must keep rising or keep falling, so that a voltage "
           "means one gap"},
      },
      read);
  expect_ranges(std::string(kFacts) + kPointsText,
                {
                    {"range_v", "[calibration]", "0.001", "1000", "0.0009", "1000.1"},
                    {"residual_mv", "[calibration]", "0", "1000000", "-0.1", "1100000"},
                    {"repeat_mv", "[calibration]", "0", "1000000", "-0.1", "1100000"},
                    {"readings_per_gap", "[calibration]", "1", "1000000000", "0", "1000000001"},
                    {"samples_per_point", "[calibration]", "1", "1000000000", "0", "1000000001"},
                    {"gap_mm", "[[point]]", "0", "1000", "-0.1", "1000.1"},
                    {"volts", "[[point]]", "-100", "100", "-100.1", "100.1"},
                },
                read);
  Problems problems;
  EXPECT_FALSE(read_sensor_curve(path("none.toml"), problems));
  EXPECT_EQ(text_of(problems), "none.toml: cannot be read: No such file or directory");
}

}  // namespace
}  // namespace dts::files
