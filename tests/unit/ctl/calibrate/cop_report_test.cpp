// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/cop_report.h"

#include <gtest/gtest.h>

#include <sstream>

#include "support/committed_text.h"
#include "unit/physics/floor_platform.h"

namespace dts::ctl {
namespace {

TEST(CopReport, SaysForWhichLoadsItIsValidAndHowWellItWasVerified) {
  const auto samples =
      physics::model_samples(physics::CopMethod::Thesis, physics::test::floor_rig(10.75), physics::PlateBehaviour::Stiffening);
  auto calibration = physics::calibrate_cop(physics::CopMethod::Thesis, samples.value(), {.created_utc = "2026-01-31T12:00:00Z"});
  ASSERT_TRUE(calibration) << calibration.error().what;
  calibration->id = "cop-1";
  calibration->points.resize(2);
  for (std::size_t k = 0; k < 2; ++k) {
    calibration->points[k].x_error_mm = 0.25 + 0.5 * static_cast<double>(k);
    calibration->points[k].y_error_mm = -0.125;
  }
  const CopReport report{.calibration = *calibration,
                         .file = "cop.toml",
                         .verification = {{.point = {86.0, 215.0, 490.0}, .x_error_mm = 3.0, .y_error_mm = -4.0},
                                          {.point = {150.5, 86.0, 240.0}, .x_error_mm = -1.0, .y_error_mm = 0.0}}};
  std::ostringstream out;
  std::ostringstream talk;
  cli::Console console{.out = out, .talk = talk};

  print(console, report);

  const std::string text = dts::test::replaced(out.str() + cli::document(to_json(report)), std::filesystem::current_path().string(), "@");
  dts::test::expect_committed("unit/ctl/calibrate/said/" + dts::test::case_file(), dts::test::rounded(text));
}

}  // namespace
}  // namespace dts::ctl
