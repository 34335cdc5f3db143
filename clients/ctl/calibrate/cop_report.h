// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/json.h"
#include "ctl/calibrate/picture.h"
#include "physics/cop/cop_calibration.h"

namespace dts::ctl {

/// A finished calibration of the centre of pressure and its errors.
struct CopReport {
  const physics::CopCalibration& calibration;
  std::string file;                      ///< The written file.
  std::vector<PointError> verification;  ///< Empty: not verified.
};

/// Returns the errors of the calibration at its own points.
[[nodiscard]] std::vector<PointError> residuals(const physics::CopCalibration& calibration);
/// Returns the error at a point that was not used for the fit.
[[nodiscard]] PointError verify(const physics::CopCalibration& calibration, const PlannedPoint& point,
                                const std::vector<double>& deflection_mm);

[[nodiscard]] cli::Json to_json(const CopReport& report);
/// Prints residual map, verification and the line for the rig's file on `console.out`.
void print(cli::Console& console, const CopReport& report);

}  // namespace dts::ctl
