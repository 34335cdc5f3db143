// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/cop_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "unit/physics/floor_platform.h"

namespace dts::ctl {
namespace {

using ::testing::HasSubstr;

TEST(CopReport, SaysForWhichLoadsItIsValidAndHowWellItWasVerified) {
  const auto samples =
      physics::model_samples(physics::CopMethod::Thesis, physics::test::floor_rig(10.75), physics::PlateBehaviour::Stiffening);
  const auto calibration = physics::calibrate_cop(physics::CopMethod::Thesis, samples.value(), {.created_utc = "2026-01-31T12:00:00Z"});
  ASSERT_TRUE(calibration) << calibration.error().what;
  const CopReport report{.calibration = *calibration,
                         .file = "cop.toml",
                         .verification = {{.point = {86.0, 215.0, 490.0}, .x_error_mm = 3.0, .y_error_mm = -4.0},
                                          {.point = {150.5, 86.0, 240.0}, .x_error_mm = -1.0, .y_error_mm = 0.0}}};
  std::ostringstream out;
  std::ostringstream talk;
  cli::Console console{.out = out, .talk = talk};

  print(console, report);

  EXPECT_THAT(out.str(), HasSubstr("valid for loads of 392 .. 588 N"));
  EXPECT_THAT(out.str(), HasSubstr("rms x 2.24, y 2.83, total 3.61 mm; at most 5.00 mm   (thesis"));
  EXPECT_DOUBLE_EQ(to_json(report).at("valid_load_n").at(0).get<double>(), 392.0);
  const auto verified = to_json(report).at("verification");
  EXPECT_DOUBLE_EQ(verified.at("rms_x_mm").get<double>(), std::sqrt(5.0));
  EXPECT_DOUBLE_EQ(verified.at("rms_y_mm").get<double>(), std::sqrt(8.0));
  EXPECT_DOUBLE_EQ(verified.at("rms_total_mm").get<double>(), std::sqrt(13.0));
  EXPECT_EQ(verified.at("max_total_mm"), 5.0);
  EXPECT_EQ(verified.at("points"), cli::Json::parse(R"([{"x_mm":86.0,"y_mm":215.0,"load_n":490.0,"x_error_mm":3.0,"y_error_mm":-4.0},
                                                        {"x_mm":150.5,"y_mm":86.0,"load_n":240.0,"x_error_mm":-1.0,"y_error_mm":0.0}])"));
}

}  // namespace
}  // namespace dts::ctl
