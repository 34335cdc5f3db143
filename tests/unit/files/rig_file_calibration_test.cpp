// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "files/cop_calibration_file.h"
#include "files/rig_file.h"
#include "unit/files/calibration_of_test.h"
#include "unit/files/files_fixture.h"

namespace dts::files {
namespace {

/// The shipped floor with a calibration for "thesis" beside it.
class RigWithCalibration : public FilesTest {
 protected:
  RigWithCalibration() {
    std::filesystem::copy(kConfig / "sensors", folder_ / "sensors");
    EXPECT_TRUE(write_cop_calibration(path("calibration.toml"), calibration_));
  }
  pipeline::RigConfig read(const std::string& text, Problems& problems) const {
    return read_rig_file(write("rigs/floor.toml", text), problems);
  }
  /// What the cop stage computes with.
  std::string estimator_with(const std::string& calibration, const std::string& estimator) const {
    Problems problems;
    const auto rig = read(edited(edited(shipped_, "# calibration", calibration), "estimator", estimator), problems);
    EXPECT_EQ(text_of(problems), "");
    EXPECT_EQ(rig.cop_calibration ? rig.cop_calibration->id : "", calibration.empty() ? "" : calibration_.id);
    const auto& options = std::ranges::find(rig.stages, "cop", &pipeline::StageConfig::id)->options;
    return options.contains("estimator") ? std::get<std::string>(options.at("estimator")) : "";
  }

  const physics::CopCalibration calibration_ = calibration_of_test(physics::CopMethod::Thesis);
  const std::string shipped_ = edited(content_of(kConfig / "rigs/floor-sim.toml"), "calibration", "# calibration");
};

constexpr const char* kCalibration = "calibration = \"../calibration.toml\"";

TEST_F(RigWithCalibration, Estimator_IsTheCalibrationsAndMayBeWritten) {
  EXPECT_EQ(estimator_with(kCalibration, ""), "thesis");
  EXPECT_EQ(estimator_with(kCalibration, "estimator = \"thesis\""), "thesis");
  EXPECT_EQ(estimator_with("", ""), "");
  EXPECT_EQ(estimator_with("", "estimator = \"poly3\""), "poly3");
}

TEST_F(RigWithCalibration, RigToCalibrate_IsReadWithoutTheRest) {
  const auto read_part = [this](const std::string& text) {
    Problems problems;
    const RigToCalibrate rig = read_rig_to_calibrate(write("rigs/floor.toml", text), problems);
    EXPECT_EQ(text_of(problems), "");
    EXPECT_EQ(rig.model.sensors.size(), 4U);
    return rig;
  };
  const std::string calibrated = edited(shipped_, "# calibration", kCalibration);
  const RigToCalibrate with = read_part(edited(calibrated, "estimator", ""));
  ASSERT_TRUE(with.calibration);
  EXPECT_EQ(with.calibration->id, calibration_.id);
  EXPECT_EQ(with.method, physics::CopMethod::Thesis);

  EXPECT_EQ(read_part(edited(shipped_, "estimator", "estimator = \"model\"")).method, physics::CopMethod::Model);
  const RigToCalibrate bare = read_part(shipped_.substr(0, shipped_.find("[[stage]]")));
  EXPECT_FALSE(bare.calibration);
  EXPECT_EQ(bare.method, physics::CopMethod::Poly3);

  Problems problems;
  (void)read_rig_to_calibrate(write("rigs/floor.toml", edited(shipped_, "estimator", "estimator = \"best\"")), problems);
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_NE(problems.front().text.find("unknown centre-of-pressure method 'best'"), std::string::npos);
}

TEST_F(RigWithCalibration, WhatDoesNotFit_IsReportedAtItsPlace) {
  const auto reading = [this](const std::string& text, Problems& problems) { (void)read(text, problems); };
  const std::string rig = edited(edited(shipped_, "# calibration", kCalibration), "estimator", "");
  std::string three = rig;
  three.erase(three.find("[[sensor]]\nlabel = \"w4\""), three.find("[[stage]]") - three.find("[[sensor]]\nlabel = \"w4\""));
  expect_problems(
      rig,
      {{"id = \"cop\"", "id = \"cop\"\nestimator = \"poly3\"",
        "rigs/floor.toml:60:13: the rig's calibration '" + calibration_.id +
            "' is for estimator \"thesis\"; leave estimator out, or set it to the same method"},
       {"id = \"cop\"", "id = \"guard\"", "rigs/floor.toml:4:15: the rig has no [[stage]] \"cop\" that could use its calibration"},
       {"calibration", "calibration = \"../none.toml\"", "rigs/floor.toml:4:15: none.toml cannot be read: No such file or directory"},
       {"calibration", "calibration = 3", "rigs/floor.toml:4:15: calibration must be a text in quotes"}},
      reading);
  expect_problems(
      three, {{"kind", "kind = \"floor\"", "rigs/floor.toml:4:15: calibration '" + calibration_.id + "' is for 4 sensors, the rig has 3"}},
      reading);
  const std::string good = content_of(path("calibration.toml"));
  for (const auto& [text, problem] : {std::pair(good + "[surprise]\n", "calibration.toml:420:2: unknown key 'surprise'"),
                                      std::pair(edited(good, "method", "method = 3"),
                                                "calibration.toml:12:10: method must be a text in quotes\n"
                                                "calibration.toml:38:1: x_mm must be a list of 1 to 3 lists\n"
                                                "calibration.toml:38:1: y_mm must be a list of 1 to 3 lists\n"
                                                "calibration.toml:31:3: unknown key 'x_ratio'\n"
                                                "calibration.toml:34:3: unknown key 'y_ratio'")}) {
    write("calibration.toml", text);
    expect_problems(rig, {{"kind", "kind = \"floor\"", problem}}, reading);
  }
}

}  // namespace
}  // namespace dts::files
