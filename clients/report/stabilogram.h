// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

#include "posturography/ellipse.h"
#include "posturography/prepare.h"
#include "report/canvas.h"

namespace dts::report {

struct PlateSize {
  double a_mm = 0.0;  ///< Along ML.
  double b_mm = 0.0;  ///< Along AP.
};

/// 95 % prediction ellipse about the mean.
struct EllipseOutline {
  double semi_major_mm = 0.0;
  double semi_minor_mm = 0.0;
  double angle_deg = 0.0;  ///< Of the major axis from +ML.
  double area_mm2 = 0.0;
};
/// Returns nothing for fewer than three samples.
[[nodiscard]] std::optional<EllipseOutline> ellipse_outline(const posturography::Prepared& prepared);

/// Half of the largest extent of path and ellipse from the mean, mm; at least 1 mm, so that a COP at rest can be drawn.
struct HalfExtent {
  double ml_mm = 1.0;
  double ap_mm = 1.0;
};
[[nodiscard]] HalfExtent half_extent(const posturography::Prepared& prepared, const std::optional<EllipseOutline>& ellipse);

/// Draws the path of the centre of pressure as seen from above: ML to the right, AP up, with the same scale in both directions; with grid,
/// ellipse, mean, and the position on the plate (if known). Fills `width` by `height`.
void draw_stabilogram(Canvas& canvas, double width, double height, const posturography::Prepared& prepared,
                      const std::optional<PlateSize>& plate);

/// Draws only path, ellipse and mean, centred at (x, y), with `paper_per_mm` mm on paper for 1 mm on the plate.
void draw_path(Canvas& canvas, double x, double y, double paper_per_mm, const posturography::Prepared& prepared, std::size_t most_points,
               double line_width);

}  // namespace dts::report
