// SPDX-License-Identifier: Apache-2.0
#include "files/cop_calibration_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <random>
#include <tuple>

#include "physics/cop/cop_evaluation.h"

namespace dts::files {
namespace {

using physics::CopMethod;
using testing::HasSubstr;

physics::RigModel floor_rig() {
  physics::RigModel rig{.plate = {}, .support = {.kind = physics::SupportKind::Corner, .inset = {10.75}}, .sensors = {}};
  for (const auto& [label, x, y] : {std::tuple{"w1", 86.0, 86.0}, {"w2", 344.0, 86.0}, {"w3", 86.0, 344.0}, {"w4", 344.0, 344.0}}) {
    rig.sensors.push_back({.label = label, .position = {{x}, {y}}, .curve = physics::SensorCurve::hoa1405_assumed()});
  }
  return rig;
}

physics::RigModel sixteen_sensors() {
  physics::RigModel rig = floor_rig();
  rig.sensors.clear();
  for (int k = 0; k < 16; ++k) {
    rig.sensors.push_back({"s", {{53.75 + 107.5 * (k % 4)}, {53.75 + 107.5 * (k / 4)}}, physics::SensorCurve::hoa1405_assumed()});
  }
  return rig;
}

physics::CopCalibration calibration(CopMethod method) {
  const auto rig = method == CopMethod::Moment ? sixteen_sensors() : floor_rig();
  const auto samples = physics::model_samples(method, rig, physics::PlateBehaviour::Stiffening).value();
  return physics::calibrate_cop(
             method, samples,
             {.created_utc = "2026-01-31T12:00:00Z", .rig = "floor", .daq_model = "the \"best\"\\one", .daq_serial = "01D2 [x]\n"})
      .value();
}

class CopCalibrationFile : public testing::TestWithParam<CopMethod> {
 protected:
  ~CopCalibrationFile() override { std::filesystem::remove(file_); }

  /// Problems of a file with this text.
  Problems problems_of(const std::string& text) {
    std::ofstream(file_) << text;
    Problems problems;
    EXPECT_FALSE(read_cop_calibration(file_, problems));
    return problems;
  }

  std::string file_ =
      testing::TempDir() + "/cop_calibration_" + std::to_string(static_cast<int>(GetParam())) + "_" + std::to_string(::getpid()) + ".toml";
};

INSTANTIATE_TEST_SUITE_P(Methods, CopCalibrationFile,
                         testing::Values(CopMethod::Poly3, CopMethod::Thesis, CopMethod::ThesisPerPair, CopMethod::Moment),
                         [](const auto& method) { return std::string(physics::to_string(method.param)); });

TEST_P(CopCalibrationFile, WrittenAndRead_EstimatesBitForBitTheSame) {
  const auto written = calibration(GetParam());

  ASSERT_TRUE(write_cop_calibration(file_, written));
  Problems problems;
  const auto read = read_cop_calibration(file_, problems);

  ASSERT_TRUE(read) << (problems.empty() ? "" : to_string(problems[0]));
  EXPECT_EQ(read->estimator.form(), written.estimator.form());
  EXPECT_EQ(read->estimator.validity(), written.estimator.validity());
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> deflection(-0.2, 6.0);
  for (int round = 0; round < 2000; ++round) {
    std::vector<double> w(written.estimator.sensor_count());
    for (double& value : w) value = deflection(random);
    const auto expected = written.estimator.estimate(w);
    const auto found = read->estimator.estimate(w);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(found.x_mm), std::bit_cast<std::uint64_t>(expected.x_mm));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(found.y_mm), std::bit_cast<std::uint64_t>(expected.y_mm));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(found.load_n), std::bit_cast<std::uint64_t>(expected.load_n));
    EXPECT_EQ(found.flags, expected.flags);
  }
}

TEST_P(CopCalibrationFile, WrittenAndRead_TellsTheSame) {
  auto written = calibration(GetParam());
  written.points.front().sample.load_position.y.value = -20.0;  // beside the plate
  ASSERT_TRUE(write_cop_calibration(file_, written));
  Problems problems;

  const auto read = read_cop_calibration(file_, problems);

  ASSERT_TRUE(read) << to_string(problems.at(0));
  EXPECT_EQ(cop_calibration_text(*read), cop_calibration_text(written));
}

TEST_P(CopCalibrationFile, EachLineMissing_IsRefusedOrHarmless) {
  // No line may be needed silently: without it, the file is refused with a place, or it was text for people or one of the points.
  const std::string text = cop_calibration_text(calibration(GetParam()));
  std::size_t refused = 0;
  const std::size_t last = text.find("[[point]]");
  for (std::size_t begin = 0; begin < last;) {
    const std::size_t end = text.find('\n', begin) + 1;
    std::ofstream(file_) << text.substr(0, begin) + text.substr(end, last - end);
    Problems problems;
    const auto read = read_cop_calibration(file_, problems);
    EXPECT_NE(read.has_value(), !problems.empty());
    refused += read ? 0 : 1;
    begin = end;
  }
  EXPECT_GT(refused, 15U);
}

class CopCalibrationFilePoly3 : public CopCalibrationFile {};
INSTANTIATE_TEST_SUITE_P(Poly3, CopCalibrationFilePoly3, testing::Values(CopMethod::Poly3));

TEST_P(CopCalibrationFilePoly3, WrongValues_AreRefusedWithTheirPlace) {
  const std::string good = cop_calibration_text(calibration(CopMethod::Poly3));
  const auto replaced = [&](const std::string& key, const std::string& line) {
    std::string text = good;
    const std::size_t begin = text.find("\n" + key + " = ") + 1;
    text.replace(begin, text.find('\n', begin) - begin, line);
    return problems_of(text);
  };
  const auto expect = [](const Problems& problems, const char* what) {
    ASSERT_FALSE(problems.empty()) << what;
    EXPECT_THAT(problems[0].text, HasSubstr(what));
    EXPECT_GT(problems[0].line, 0U);
    EXPECT_GT(problems[0].column, 0U);
  };

  expect(replaced("format", "format = 2"), "format 2 is not known; this program reads format 1");
  expect(replaced("created_utc", "created_utc = \"yesterday\""), "must be like");
  expect(replaced("method", "method = \"model\""), "is not known");
  expect(replaced("method", "method = \"moment\""), "sensors = 4 is out of range");
  expect(replaced("sensors", "sensors = 400000000"), "out of range; allowed: 4 .. 4");
  expect(replaced("u", "u = [0.0]"), "u must be a list of 2 numbers");
  expect(replaced("u", "u = [0.0, nan]"), "u: number 2 of the list is not a finite number");
  expect(replaced("u", "u = [1.0, -1.0]"), "the lowest value of a range comes first");
  expect(replaced("reference_sum_mm", "reference_sum_mm = inf"), "out of range");
  expect(replaced("reference_sum_mm", "reference_sum_m = 1.0"), "reference_sum_mm is missing");
  expect(replaced("load_n", "load_n = [-5.0, 1.0]"), "load range makes no sense");
  expect(replaced("load_n", "load_n = [0.0, 1.0]\nload_kg = 1"), "unknown key 'load_kg'");
}

TEST_P(CopCalibrationFilePoly3, CoefficientsOfAnotherSize_AreRefused) {
  std::string text = cop_calibration_text(calibration(CopMethod::Poly3));
  const std::size_t row = text.find("  [", text.find("\nsum_mm_per_n = ["));
  const std::size_t end = text.find('\n', row);

  EXPECT_THAT(problems_of(std::string(text).replace(row, end - row, "  [1.0, 2.0],"))[0].text, HasSubstr("must be a list of 21 numbers"));
  EXPECT_THAT(problems_of(std::string(text).replace(row, end - row, ""))[0].text, HasSubstr("rows, another output has 2"));
  EXPECT_THAT(problems_of(std::string(text).replace(row, end - row, text.substr(row, end - row) + text.substr(row, end - row)))[0].text,
              HasSubstr("must be a list of 1 to 3 lists"));
}

TEST_P(CopCalibrationFilePoly3, FileOrFolderThatIsNotThere_IsSaid) {
  Problems problems;
  EXPECT_FALSE(read_cop_calibration(testing::TempDir() + "/no_such_calibration.toml", problems));
  EXPECT_EQ(problems.size(), 1U);
  const auto status = write_cop_calibration(testing::TempDir() + "/no_such_folder/cal.toml", calibration(CopMethod::Poly3));

  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().what, HasSubstr("no_such_folder/cal.toml"));
}

TEST_P(CopCalibrationFilePoly3, Head_TellsHowToCompute) {
  const std::string text = cop_calibration_text(calibration(CopMethod::Poly3));

  EXPECT_THAT(text, testing::StartsWith("# Calibration of the centre of pressure"));
  EXPECT_THAT(text, HasSubstr("u = (w2 + w4 - w1 - w3) / S"));
}

}  // namespace
}  // namespace dts::files
