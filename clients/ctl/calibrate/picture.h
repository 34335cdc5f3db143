// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ctl/calibrate/plan.h"

namespace dts::ctl {

/// Returns the plate from above, forward at the top, sensors as 'o' and the spot as 'X'; lines end with '
/// '.
[[nodiscard]] std::string spot_picture(const PlateView& plate, const PlannedPoint& spot);

/// Returns "x 86.00, y 215.00 mm from the left back corner (-129.00, 0.00 mm from the centre)".
[[nodiscard]] std::string place_text(const PlateView& plate, const PlannedPoint& spot);

/// The difference between an estimate and the true place at one point.
struct PointError {
  PlannedPoint point;
  double x_error_mm = 0.0;
  double y_error_mm = 0.0;

  [[nodiscard]] double total_mm() const noexcept;
};

struct ErrorSummary {
  double rms_x_mm = 0.0;
  double rms_y_mm = 0.0;
  double rms_total_mm = 0.0;  ///< Radial.
  double max_total_mm = 0.0;
};
[[nodiscard]] ErrorSummary summary(const std::vector<PointError>& errors);

/// Returns one map per load: a symbol per point, distinguished by shape and not by colour, with legend, rms and maximum.
[[nodiscard]] std::string error_map(const std::vector<PointError>& errors);

}  // namespace dts::ctl
