// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/cop_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "unit/physics/floor_platform.h"

namespace dts::ctl {
namespace {

TEST(CopReport, SaysForWhichLoadsTheCalibrationIsValid) {
  const auto samples =
      physics::model_samples(physics::CopMethod::Thesis, physics::test::floor_rig(10.75), physics::PlateBehaviour::Stiffening);
  const auto calibration = physics::calibrate_cop(physics::CopMethod::Thesis, samples.value(), {.created_utc = "2026-01-31T12:00:00Z"});
  ASSERT_TRUE(calibration) << calibration.error().what;
  const CopReport report{.calibration = *calibration, .file = "cop.toml", .verification = {}};
  std::ostringstream out;
  std::ostringstream talk;
  cli::Console console{.out = out, .talk = talk};

  print(console, report);

  EXPECT_THAT(out.str(), ::testing::HasSubstr("valid for loads of 392 .. 588 N"));
  EXPECT_DOUBLE_EQ(to_json(report).at("valid_load_n").at(0).get<double>(), 392.0);
}

}  // namespace
}  // namespace dts::ctl
