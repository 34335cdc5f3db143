// SPDX-License-Identifier: Apache-2.0
#include "files/cop_calibration_file.h"

#include <gmock/gmock.h>

#include "unit/files/calibration_of_test.h"
#include "unit/files/files_fixture.h"
#include "unit/physics/cop/constant_two_feet.h"

namespace dts::files {
namespace {

using physics::CopMethod;
using testing::HasSubstr;

class CopCalibrationFile : public FilesTest {
 protected:
  static void read(const std::string& text, Problems& problems) {
    const auto table = parse_toml_text(text, "cop", problems);
    if (!table) return;
    TomlReader reader(&*table, "", "cop", problems);
    const bool is_read = read_cop_calibration(reader, problems).has_value();
    EXPECT_EQ(is_read, problems.empty());
  }
  static std::string good(CopMethod method) { return cop_calibration_text(calibration_of_test(method)); }
  static std::string without_points(CopMethod method) {
    const std::string text = good(method);
    return text.substr(0, text.find("[[point]]"));
  }
};

auto figures_of(const physics::CopErrorFigures& figures) {
  const auto& [rms_x, rms_y, rms_total, max_total, load_rms] = figures;
  return std::tuple(rms_x, rms_y, rms_total, max_total, load_rms);
}

class EveryMethod : public CopCalibrationFile, public testing::WithParamInterface<CopMethod> {};

INSTANTIATE_TEST_SUITE_P(CopCalibrationFile, EveryMethod,
                         testing::Values(CopMethod::Poly3, CopMethod::Thesis, CopMethod::ThesisPerPair, CopMethod::Moment),
                         [](const auto& method) { return std::string(physics::to_string(method.param)); });

TEST_P(EveryMethod, WrittenAndRead_AreTheSame) {
  auto written = calibration_of_test(GetParam());
  written.origin.daq_serial = "01D2 [x]\n";
  written.points.front().sample.load_position = {{-10.0}, {-20.0}};  // beside the plate
  written.cross_validated = {.rms_x_mm = 1.0, .rms_y_mm = 2.0, .rms_total_mm = 3.0, .max_total_mm = 4.0, .load_rms_percent = 5.0};

  ASSERT_TRUE(write_cop_calibration(path("cop.toml"), written));
  Problems problems;
  const auto read = read_cop_calibration(path("cop.toml"), problems);

  ASSERT_TRUE(read) << text_of(problems);
  EXPECT_EQ(read->id, written.id);
  const auto& [created_utc, rig, daq_model, daq_serial] = read->origin;
  EXPECT_EQ(std::tie(created_utc, rig, daq_model, daq_serial),
            std::tuple("2026-01-31T12:00:00Z", "floor", "the \"best\"\\one", "01D2 [x]\n"));
  EXPECT_EQ(read->estimator.method(), GetParam());
  EXPECT_EQ(read->estimator.form(), written.estimator.form());
  EXPECT_EQ(read->estimator.validity(), written.estimator.validity());
  EXPECT_EQ(figures_of(read->residuals), figures_of(written.residuals));
  EXPECT_EQ(figures_of(read->cross_validated.value()), figures_of(*written.cross_validated));
  ASSERT_EQ(read->points.size(), written.points.size());
  for (std::size_t k = 0; k < read->points.size(); ++k) {
    const auto values = [](const physics::CopCalibrationPoint& point) {
      return std::tuple(point.sample.load_position, point.sample.load, point.sample.deflection_mm, point.x_error_mm, point.y_error_mm,
                        point.load_error_percent);
    };
    EXPECT_EQ(values(read->points[k]), values(written.points[k]));
  }
}

TEST_P(EveryMethod, EachLineMissing_IsRefusedOrHarmless) {
  // No line may be needed silently: without it, the file is refused with a place, or it was text for people or one of the points.
  const std::string text = good(GetParam());
  std::size_t refused = 0;
  const std::size_t last = text.find("[[point]]");
  for (std::size_t begin = 0; begin < last;) {
    const std::size_t end = text.find('\n', begin) + 1;
    Problems problems;
    read(text.substr(0, begin) + text.substr(end, last - end), problems);
    refused += problems.empty() ? 0 : 1;
    begin = end;
  }
  EXPECT_GT(refused, 15U);
}

TEST_F(CopCalibrationFile, Limits_AreReportedWithPlaceAndRange) {
  const std::string head = without_points(CopMethod::Poly3);
  const std::string point =
      "[[point]]\nx_mm = 1e5\ny_mm = -1e5\nload_n = 1e6\nw_mm = [0, 0, 0, 0]\nx_error_mm = 1\ny_error_mm = 1\nload_error_percent = 1\n";
  const std::string row =
      "  [" + std::string("0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, ");
  expect_problems(
      head + point,
      {
          {"format", "format = 2", "cop:6:10: format 2 is not known; this program reads format 1"},
          {"format", "format = 0", "cop:6:10: format 0 is not known; this program reads format 1"},
          {"format", "", "cop:1:1: format is missing"},
          {"id", "", "cop:1:1: id is missing"},
          {"id", "id = \"" + std::string(201, 'i') + "\"", "cop:7:6: id is longer than 200 characters"},
          {"id", "id = \"" + std::string(200, 'i') + "\"", ""},
          {"created_utc", "created_utc = \"yesterday\"", "cop:8:15: created_utc must be like \"2026-01-31T12:00:00Z\""},
          {"rig", "rig = 3\ndaq = 1",
           "cop:9:7: rig must be a text in quotes\n"
           "cop:10:1: unknown key 'daq'"},
          {"daq_model", "daq_model = 3", "cop:10:13: daq_model must be a text in quotes"},
          {"daq_serial", "daq_serial = 3", "cop:11:14: daq_serial must be a text in quotes"},
          {"method", "method = \"model\"",
           "cop:12:10: method = \"model\" is not known; known: \"poly3\", \"thesis\", \"thesis_per_pair\", \"moment\""},
          {"x_mm", "x_mm = [-1e5, 1e5]", ""},
          {"x_mm", "x_mm = [-1.1e5, 1e5]", "cop:16:8: x_mm: number 1 of the list is not a finite number of at most 100000 in size"},
          {"x_mm", "x_mm = [1.0, 1.0]", ""},
          {"x_mm", "x_mm = [1.1, 1.0]", "cop:16:8: x_mm: write the lowest value of a range first"},
          {"y_mm", "y_mm = [0.0, 1.1e5]", "cop:17:8: y_mm: number 2 of the list is not a finite number of at most 100000 in size"},
          {"load_n", "load_n = [0.0, 1e6]", ""},
          {"load_n", "load_n = [0.0, 1.1e6]", "cop:18:10: load_n: number 2 of the list is not a finite number of at most 1000000 in size"},
          {"load_n", "load_n = [-5.0, 1.0]", "cop:12:10: centre-of-pressure calibration: the calibrated load range is not valid"},
          {"load_n", "load_n = [0.0, 1.0]\nload_kg = 1", "cop:19:1: unknown key 'load_kg' in [valid]; did you mean 'load_n'?"},
          {"rms_x_mm", "rms_x_mm = 1.1e30\nrms = 2",
           "cop:22:12: [residuals] rms_x_mm = 1.1e+30 is out of range; allowed: 0 .. 1e+30\n"
           "cop:23:1: unknown key 'rms' in [residuals]"},
          {"rms_y_mm", "", "cop:21:1: [residuals] rms_y_mm is missing"},
          {"[polynomial]", "[polynom]",
           "cop: u must be a list of 2 numbers\n"
           "cop: v must be a list of 2 numbers\n"
           "cop: relative_sum must be a list of 2 numbers\n"
           "cop: [polynomial] is missing\n"
           "cop: sum_mm_per_n must be a list of 1 to 3 lists\n"
           "cop: x_mm must be a list of 1 to 3 lists\n"
           "cop: y_mm must be a list of 1 to 3 lists\n"
           "cop:36:2: unknown key 'polynom'"},
          {"u", "u = [0.0]", "cop:41:5: u must be a list of 2 numbers"},
          {"u", "u = [0.0, nan]", "cop:41:5: u: number 2 of the list is not a finite number of at most 1e+30 in size"},
          {"v", "v = [0.0, 1.1e30]", "cop:42:5: v: number 2 of the list is not a finite number of at most 1e+30 in size"},
          {"relative_sum", "relative_sum = 1.0", "cop:43:16: relative_sum must be a list of 2 numbers"},
          {"reference_sum_mm", "reference_sum_mm = inf",
           "cop:44:20: [polynomial] reference_sum_mm = inf is out of range; allowed: 1e-09 .. 1e+30"},
          {"reference_sum_mm", "reference_sum_m = 1.0",
           "cop:36:1: [polynomial] reference_sum_mm is missing\n"
           "cop:44:1: unknown key 'reference_sum_m' in [polynomial]; did you mean 'reference_sum_mm'?"},
          {"  [", row + "1e30],", ""},
          {"  [", row + "1.1e30],", "cop:45:8: x_mm: number 21 of the list is not a finite number of at most 1e+30 in size"},
          {"  [", row + "0.0, 0.0],", "cop:45:8: x_mm must be a list of 21 numbers"},
          {"  [", "  [1.0, 2.0],", "cop:45:8: x_mm must be a list of 21 numbers"},
          {"  [", "  # no row", "cop:45:8: x_mm has 2 rows, another output has 3"},
          {"  [", row + "0.0],\n" + row + "0.0],", "cop:45:8: x_mm must be a list of 1 to 3 lists"},
          {"[[point]]", "[[point]]\nx = 1", "cop:63:1: unknown key 'x' in [[point]]"},
          {"w_mm", "w_mm = [1e3, -1e3, 0, 0]", ""},
          {"w_mm", "w_mm = [1.1e3, -1e3, 0, 0]", "cop:66:8: w_mm: number 1 of the list is not a finite number of at most 1000 in size"},
          {"w_mm", "w_mm = [1, 2, 3]", "cop:66:8: w_mm must be a list of 4 numbers"},
          {"load_error_percent", "", ""},
          {"load_n = 1e6", "", "cop:62:1: [[point]] load_n is missing"},
      },
      read);
  expect_ranges(head + point,
                {
                    {"sensors", "", "4", "4", "3", "5"},
                    {"rms_x_mm", "[residuals]", "0", "1e+30", "-0.1", "1.1e+30"},
                    {"reference_sum_mm", "[polynomial]", "1e-09", "1e+30", "9e-10", "1.1e+30"},
                    {"x_error_mm", "[[point]]", "-1e+30", "1e+30", "-1.1e+30", "1.1e+30"},
                    {"y_error_mm", "[[point]]", "-1e+30", "1e+30", "-1.1e+30", "1.1e+30"},
                    {"load_error_percent", "[[point]]", "-1e+30", "1e+30", "-1.1e+30", "1.1e+30"},
                    {"load_n = 1e6", "[[point]]", "1e-09", "1000000", "9e-10", "1100000"},
                    {"x_mm = 1e5", "[[point]]", "-100000", "100000", "-110000", "110000"},
                    {"y_mm = -1e5", "[[point]]", "-100000", "100000", "-110000", "110000"},
                },
                read);
  std::string many;
  for (int count = 0; count < 10'000; ++count) many += point;
  expect_problems(head + many,
                  {{"[[point]]", "[[point]]", ""}, {"[[point]]", point + "[[point]]", "cop:62:1: 10001 points; at most 10000 are allowed"}},
                  read);
}

TEST_F(CopCalibrationFile, FormsOfOtherMethods_AreRefusedAtTheirPlace) {
  expect_problems(without_points(CopMethod::Thesis),
                  {{"method", "method = \"thesis_per_pair\"",
                    "cop:31:1: [[x_ratio]] must appear twice for this method\n"
                    "cop:34:1: [[y_ratio]] must appear twice for this method"},
                   {"[[x_ratio]]", "[[z_ratio]]",
                    "cop:1:1: [[x_ratio]] must appear once for this method\n"
                    "cop:31:3: unknown key 'z_ratio'; did you mean 'x_ratio'?"},
                   {"ratio", "ratio = [2.0, 1.0]\nfit = 3",
                    "cop:32:9: ratio: write the lowest value of a range first\n"
                    "cop:33:1: unknown key 'fit' in [[x_ratio]]"},
                   {"quartic", "quartic = [1, 2, 3, 4]", "cop:33:11: quartic must be a list of 5 numbers"},
                   {"quartic", "quartic = [1, 2, 3, 4, 1.1e30]",
                    "cop:33:11: quartic: number 5 of the list is not a finite number of at most 1e+30 in size"},
                   {"u", "u = [0.0, 1.0]\nx_mm = [[1.0]]", "cop:44:1: unknown key 'x_mm' in [polynomial]"}},
                  read);
  expect_problems(without_points(CopMethod::ThesisPerPair),
                  {{"method", "method = \"thesis\"",
                    "cop:31:1: [[x_ratio]] must appear once for this method\n"
                    "cop:37:1: [[y_ratio]] must appear once for this method"}},
                  read);
  std::string shares = "[1.0, 0.0]";
  for (int count = 1; count < 16; ++count) shares += ", [0.0, 1.0]";
  const std::string moment = without_points(CopMethod::Moment);
  expect_problems(
      moment,
      {{"sensors", "sensors = 4",
        "cop:13:11: sensors = 4 is out of range; allowed: 5 .. 32\n"
        "cop:42:17: load_n_per_mm must be a list of 4 numbers\n"
        "cop:43:14: x_moment_n must be a list of 4 numbers\n"
        "cop:44:14: y_moment_n must be a list of 4 numbers\n"
        "cop:45:18: x_quadratic_mm must be a list of 10 numbers\n"
        "cop:46:18: y_quadratic_mm must be a list of 10 numbers\n"
        "cop:47:9: share must be a list of 4 ranges"},
       {"sensors", "sensors = 17",
        "cop:42:17: load_n_per_mm must be a list of 17 numbers\n"
        "cop:43:14: x_moment_n must be a list of 17 numbers\n"
        "cop:44:14: y_moment_n must be a list of 17 numbers\n"
        "cop:45:18: x_quadratic_mm must be a list of 153 numbers\n"
        "cop:46:18: y_quadratic_mm must be a list of 153 numbers\n"
        "cop:47:9: share must be a list of 17 ranges"},
       {"x_centre_mm", "x_centre_mm = 1e5", ""},
       {"x_centre_mm", "x_centre_mm = 1.1e5", "cop:40:15: [moment] x_centre_mm = 110000 is out of range; allowed: -100000 .. 100000"},
       {"x_centre_mm", "x_centre_mm = -1.1e5\nz_centre_mm = 1",
        "cop:40:15: [moment] x_centre_mm = -110000 is out of range; allowed: -100000 .. 100000\n"
        "cop:41:1: unknown key 'z_centre_mm' in [moment]; did you mean 'x_centre_mm'?"},
       {"y_centre_mm", "y_centre_mm = -1e5", ""},
       {"y_centre_mm", "y_centre_mm = -1.1e5", "cop:41:15: [moment] y_centre_mm = -110000 is out of range; allowed: -100000 .. 100000"},
       {"y_centre_mm", "y_centre_mm = 1.1e5", "cop:41:15: [moment] y_centre_mm = 110000 is out of range; allowed: -100000 .. 100000"},
       {"load_n_per_mm", "load_n_per_mm = [1]", "cop:42:17: load_n_per_mm must be a list of 16 numbers"},
       {"x_moment_n", "x_moment_n = [1]", "cop:43:14: x_moment_n must be a list of 16 numbers"},
       {"y_moment_n", "y_moment_n = [1]", "cop:44:14: y_moment_n must be a list of 16 numbers"},
       {"x_quadratic_mm", "", "cop:36:1: x_quadratic_mm must be a list of 136 numbers"},
       {"y_quadratic_mm", "y_quadratic_mm = [1]", "cop:46:18: y_quadratic_mm must be a list of 136 numbers"},
       {"share", "share = [[0.0, 1.0]]", "cop:47:9: share must be a list of 16 ranges"},
       {"share", "share = 1", "cop:47:9: share must be a list of 16 ranges"},
       {"share", "share = [" + shares + "]", "cop:47:9: share: write the lowest value of a range first"}},
      read);
  expect_problems(edited(moment, "x_quadratic_mm", ""), {{"y_quadratic_mm", "", ""}}, read);
}

/// With a correction for two feet, and without points.
physics::CopCalibration with_two_feet() {
  physics::CopCalibration calibration = calibration_of_test(CopMethod::Poly3);
  calibration.points.clear();
  physics::TwoFeetForm form = physics::test::constant_form();
  for (std::size_t k = 0; k < form.with_width.x_mm.size(); ++k) form.with_width.x_mm[k] = 1.0 / (1.0 + static_cast<double>(k));
  form.travel_mm = 4.5;
  calibration.two_feet = physics::TwoFeetCorrection::from_form(form).value();
  return calibration;
}

TEST_F(CopCalibrationFile, CorrectionForTwoFeet_ReadsBackTheSame) {
  const physics::CopCalibration written = with_two_feet();

  ASSERT_TRUE(write_cop_calibration(path("cop.toml"), written));
  Problems problems;
  const auto read = read_cop_calibration(path("cop.toml"), problems);

  ASSERT_TRUE(read) << text_of(problems);
  ASSERT_TRUE(read->two_feet);
  EXPECT_EQ(read->two_feet->form(), written.two_feet->form());
  EXPECT_TRUE(read->points.empty());
  EXPECT_THAT(cop_calibration_text(*read), HasSubstr("x_mm += p of x_mm"));
  EXPECT_EQ(cop_calibration_text(*read), cop_calibration_text(written));
}

TEST_F(CopCalibrationFile, MistakesInTheCorrectionForTwoFeet_AreReportedWithTheirPlace) {
  const std::string text = cop_calibration_text(with_two_feet());
  const std::string correction = text.substr(text.find("\n[two_feet]\n"));
  const std::string head = text.substr(0, text.size() - correction.size());
  const auto problems_of = [&](const std::string& line, const std::string& by) {
    Problems problems;
    read(head + edited(correction, line, by), problems);
    std::string found;  // without the place, which is that of the line
    for (const Problem& problem : problems) found += (found.empty() ? "" : "\n") + problem.text + (problem.line > 60 ? "" : " ?");
    return found;
  };
  EXPECT_EQ(problems_of("travel_mm", "travel_mm = 1e3"), "");
  EXPECT_EQ(problems_of("travel_mm", "travel_mm = 0.0"), "[two_feet] travel_mm = 0 is out of range; allowed: 0.1 .. 1000");
  EXPECT_EQ(problems_of("travel_mm", ""), "[two_feet] travel_mm is missing");
  EXPECT_EQ(problems_of("travel_mm", "travel_mm = 5\nfeet = 2"), "unknown key 'feet' in [two_feet]");
  EXPECT_EQ(problems_of("mean", "mean = [1, 2, 3]"), "mean must be a list of 4 numbers");
  EXPECT_EQ(problems_of("sd", "sd = [1, 2, 0, 4]"), "sd: every number must be positive");
  EXPECT_EQ(problems_of("highest", "highest = [1e3, 1e3, 399, 1e3]"), "highest: a number is below the one in lowest");
  EXPECT_EQ(problems_of("x_mm", "x_mm = [1.0]"), "x_mm must be a list of 35 numbers");
  EXPECT_EQ(problems_of("log_load", "log_load = [nan]"), "log_load must be a list of 35 numbers");
  EXPECT_EQ(problems_of("highest", "highest = [1e9, 1e9, 1e9, 1e9]"),
            "centre-of-pressure calibration: a number, a range or a count of the correction for two feet is not valid");
  EXPECT_THAT(problems_of("[two_feet.without_width]", "[two_feet.no_width]"), HasSubstr("unknown key 'no_width' in [two_feet]"));
}

TEST_F(CopCalibrationFile, FileOrFolderThatIsNotThere_IsReported) {
  Problems problems;
  EXPECT_FALSE(read_cop_calibration(path("none.toml"), problems));
  EXPECT_EQ(text_of(problems), "none.toml: cannot be read: No such file or directory");
  EXPECT_THAT(write_cop_calibration(path("none/cal.toml"), calibration_of_test(CopMethod::Poly3)).error().what, HasSubstr("none/cal.toml"));
}

TEST_F(CopCalibrationFile, Text_SaysHowToCompute) {
  const std::string text = good(CopMethod::Poly3);

  EXPECT_THAT(text, testing::StartsWith("# Calibration of the centre of pressure"));
  EXPECT_THAT(text, HasSubstr("u = (w2 + w4 - w1 - w3) / S"));
}

}  // namespace
}  // namespace dts::files
