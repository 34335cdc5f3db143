// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/result.h"
#include "lab/base/gnuplot.h"
#include "physics/plate/plate.h"

namespace dts::lab {

/// Points marked on a map, with a name in the legend.
struct Marks {
  std::string name;  ///< "load"
  int symbol = 7;    ///< gnuplot's point type.
  double size = 1.5;
  std::vector<physics::Point> points;
};

/// Returns the point supports, or some points along supported edges, as marks.
[[nodiscard]] Marks support_marks(const physics::Plate& plate, const physics::Support& support);

/// A quantity over a rectangle of the plate: heat map with contour lines, in colours that colour-blind people can distinguish (viridis).
/// NaN leaves an empty spot.
struct PlateMap {
  std::string title;
  std::string quantity;  ///< With unit: "deflection (mm)".
  physics::Point from;   ///< Bottom left corner of the rectangle.
  physics::Point to;
  int cells = 80;  ///< In both directions.
  std::function<double(physics::Point)> value;
  std::vector<Marks> marks;
  std::vector<physics::Patch> patches;  ///< Drawn as rectangles.
  physics::Plate plate;                 ///< Its outline is drawn.
};

[[nodiscard]] core::Status draw_map(const PlateMap& map, const std::string& file);
/// Returns the script for gnuplot without the terminal; for tests.
[[nodiscard]] std::string map_script(const PlateMap& map);

enum class CurveStyle : std::uint8_t { LinesPoints, Lines, Points };

/// A curve of an XY plot, with its name in the legend.
struct Curve {
  std::string name;
  std::vector<std::pair<double, double>> points;
  CurveStyle style = CurveStyle::LinesPoints;
};
struct CurvePlot {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<Curve> curves;
  bool is_from_zero = true;  ///< The y axis starts at 0.
};
[[nodiscard]] core::Status draw_curves(const CurvePlot& plot, const std::string& file);

}  // namespace dts::lab
