// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/json.h"
#include "ctl/calibrate/picture.h"
#include "physics/cop/cop_calibration.h"

namespace dts::ctl {

/// What a finished calibration of the centre of pressure is worth.
struct CopReport {
  const physics::CopCalibration& calibration;
  std::string file;                      ///< Where it was written.
  std::vector<PointError> verification;  ///< Empty: none was made.
};

/// Errors of the calibration at its own points.
[[nodiscard]] std::vector<PointError> residuals(const physics::CopCalibration& calibration);
/// Errors at points that the calibration has not seen.
[[nodiscard]] PointError verify(const physics::CopCalibration& calibration, const PlannedPoint& point,
                                const std::vector<double>& deflection_mm);

[[nodiscard]] cli::Json to_json(const CopReport& report);
/// Residual map, verification and the line for the rig's file, on `console.out`.
void print(cli::Console& console, const CopReport& report);

}  // namespace dts::ctl
