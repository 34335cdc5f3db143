// SPDX-License-Identifier: Apache-2.0
// Thesis table 3.6: how little the ratio of two deflections changes while the load moves along a line across the plate.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "lab/point_response.h"
#include "lab/thesis_parts.h"
#include "lab/thesis_setup.h"
#include "lab/thesis_tables.h"

namespace dts::lab {
namespace {

using physics::PlateMethod;
using physics::Point;
using printed::kLines;

using Line = std::vector<Point>;

/// Returns loads for two sensors side by side at y = 86: five lines parallel to y from the middle towards a sensor, five loads on each. The
/// first load is nearest to the line through the sensors. Figures 3.15 and 3.16 are missing; the extent is fitted (research sheet, section
/// 4).
std::array<Line, kLines> neighbour_lines() {
  constexpr double kFirstX = 215.0;
  constexpr double kLastX = 149.0;
  constexpr double kFirstY = 54.0;
  constexpr double kLastY = 215.0;
  std::array<Line, kLines> lines;
  for (std::size_t line = 0; line < kLines; ++line) {
    for (int k = 0; k < 5; ++k) {
      lines[line].push_back({{kFirstX + (kLastX - kFirstX) * static_cast<double>(line) / 4.0}, {kFirstY + (kLastY - kFirstY) * k / 4.0}});
    }
  }
  return lines;
}

/// Returns loads for two sensors at opposite corners of the sensor square: lines across their diagonal, starting on it, with 7, 6, 5, 4 and
/// 3 loads, so that they fill a quarter of the plate. Pitch fitted as above.
std::array<Line, kLines> opposite_lines() {
  constexpr double kPitchMm = 29.5;
  std::array<Line, kLines> lines;
  for (std::size_t line = 0; line < kLines; ++line) {
    const double start_mm = thesis_setup::kCentre.x.value - kPitchMm / 2.0 * static_cast<double>(line);
    for (std::size_t k = 0; k + line < 7; ++k) {
      const double away_mm = kPitchMm * static_cast<double>(k);
      lines[line].push_back({{start_mm - away_mm}, {start_mm + away_mm}});
    }
  }
  return lines;
}

/// Returns thesis eq. 3.15 along one line: mean magnitude, %.
double mean_error_percent(const PointResponse& plate, const Line& line) {
  const auto proportion = [&](Point load) {
    const auto deflection_mm = plate.deflection_mm(load, {10.0});
    return deflection_mm[0] / deflection_mm[1];
  };
  const double reference = proportion(line.front());
  double sum = 0.0;
  for (const Point& load : line) sum += std::abs(100.0 * (proportion(load) - reference) / reference);
  return sum / static_cast<double>(line.size());
}

core::Result<std::array<double, kLines>> line_errors(const printed::LineErrors& row, PlateMethod method) {
  const Point first{{thesis_setup::kSensorMm}, {thesis_setup::kSensorMm}};
  const Point second{{thesis_setup::kFarSensorMm}, {row.is_opposite ? thesis_setup::kFarSensorMm : thesis_setup::kSensorMm}};
  const physics::Support support{.kind = row.is_edge_supported ? physics::SupportKind::Edges : physics::SupportKind::Corner};
  const auto plate = PointResponse::create(thesis_setup::acrylic(), support, std::array{first, second}, method, thesis_setup::kDivisions);
  if (!plate) return tl::make_unexpected(plate.error());
  const auto lines = row.is_opposite ? opposite_lines() : neighbour_lines();
  std::array<double, kLines> errors{};
  std::ranges::transform(lines, errors.begin(), [&](const Line& line) { return mean_error_percent(*plate, line); });
  return errors;
}

double mean(const std::array<double, kLines>& values) { return std::accumulate(values.begin(), values.end(), 0.0) / kLines; }

std::string name_of(const printed::LineErrors& row) {
  return std::string(row.is_opposite ? "opposite" : "neighbour") + ", " + (row.is_edge_supported ? "edge" : "corner") + " supported";
}

std::string key_of(const printed::LineErrors& row) {
  return std::string("mean_") + (row.is_edge_supported ? "edge_" : "corner_") + (row.is_opposite ? "opposite" : "neighbour") + "_percent";
}

}  // namespace

core::Result<ThesisTable> thesis_line_errors() {
  ThesisTable table{
      .name = "3.6",
      .title = "Mean error of a proportion along five lines of loads",
      .rows = {},
      .summary = {},
      .notes = {"The load points of Fig. 3.14 to 3.16 are missing; they are fitted to this table, so agreement proves nothing.",
                "Sensors at 86 mm; supports at the corners or all along the edges; acrylic 4 mm.",
                "The mean printed for neighbours with supported edges, 11.032, is not that of its five lines, 10.590.",
                "Line 1 is 0 by symmetry: the printed values there are noise of the mesh in the thesis.",
                "Corner supports and neighbouring sensors are best for every sensor position from 20 to 106 mm."}};
  for (const printed::LineErrors& row : printed::kLineErrors) {
    const auto fdm = line_errors(row, PlateMethod::Fdm);
    if (!fdm) return tl::make_unexpected(fdm.error());
    const auto fem = line_errors(row, PlateMethod::Fem);
    if (!fem) return tl::make_unexpected(fem.error());
    const auto add = [&](const std::string& label, double printed_percent, double fem_percent, double fdm_percent) {
      table.rows.push_back({.label = name_of(row) + ", " + label,
                            .printed = {{"percent", printed_percent}},
                            .ours = {{"fem_percent", fem_percent}, {"fdm_percent", fdm_percent}},
                            .deviation = {{"fem_points", fem_percent - printed_percent}, {"fdm_points", fdm_percent - printed_percent}}});
    };
    for (std::size_t line = 0; line < kLines; ++line) {
      add("line " + std::to_string(line + 1), row.line_percent[line], (*fem)[line], (*fdm)[line]);
    }
    add("mean", row.mean_percent, mean(*fem), mean(*fdm));
    table.summary.push_back({key_of(row), mean(*fdm)});
  }
  return table;
}

}  // namespace dts::lab
