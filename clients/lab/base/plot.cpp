// SPDX-License-Identifier: Apache-2.0
#include "lab/base/plot.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace dts::lab {
namespace {

using physics::Point;

/// Five knots of matplotlib's viridis.
constexpr auto kPalette =
    "set palette defined (0 '#440154', 1 '#3b528b', 2 '#21918c', 3 '#5ec962', 4 '#fde725')\n"
    "set datafile missing 'nan'\n"
    "set tics out nomirror\n";

/// Quotes a text in gnuplot's single quotes.
std::string gnuplot_text(const std::string& text) {
  std::string safe = "'";
  for (const char letter : text) {
    if (letter == '\'') safe += '\'';
    safe += letter == '\n' ? ' ' : letter;
  }
  return safe + "'";
}

void write_number(std::ostream& script, double value) {
  if (std::isfinite(value)) {
    script << value;
  } else {
    script << "nan";
  }
}

/// Writes the data block $field: x y value, row by row, with an empty line between rows.
void write_field(std::ostream& script, const PlateMap& map) {
  script << "$field << END\n";
  for (int j = 0; j <= map.cells; ++j) {
    for (int i = 0; i <= map.cells; ++i) {
      const Point at{map.from.x + (map.to.x - map.from.x) * i / map.cells, map.from.y + (map.to.y - map.from.y) * j / map.cells};
      script << at.x.value << ' ' << at.y.value << ' ';
      write_number(script, map.value(at));
      script << '\n';
    }
    script << '\n';
  }
  script << "END\n";
}

void write_marks(std::ostream& script, const std::vector<Marks>& all) {
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (all[k].points.empty()) continue;
    script << "$marks" << k << " << END\n";
    for (const Point& point : all[k].points) script << point.x.value << ' ' << point.y.value << '\n';
    script << "END\n";
  }
}

void write_patches(std::ostream& script, const std::vector<physics::Patch>& patches) {
  for (const physics::Patch& patch : patches) {
    script << "set object rectangle center " << patch.centre.x.value << ',' << patch.centre.y.value << " size " << patch.width.value << ','
           << patch.height.value << " front fillstyle empty border lc rgb '#d1495b' lw 2\n";
  }
}

}  // namespace

std::string map_script(const PlateMap& map) {
  std::ostringstream script;
  script.precision(9);
  write_field(script, map);
  write_marks(script, map.marks);
  write_patches(script, map.patches);
  const std::string a = std::to_string(map.plate.a.value);
  const std::string b = std::to_string(map.plate.b.value);
  script << kPalette << "set title " << gnuplot_text(map.title) << " noenhanced\nset cblabel " << gnuplot_text(map.quantity)
         << " noenhanced\n"
         << "set cblabel offset 1.5\nset xlabel 'x (mm)'\nset ylabel 'y (mm)'\nset size ratio -1\nset key below\n"
         << "set xrange [" << -0.04 * map.plate.a.value << ':' << 1.04 * map.plate.a.value << "]\nset yrange [" << -0.04 * map.plate.b.value
         << ':' << 1.04 * map.plate.b.value << "]\n"
         << "set contour base\nset cntrparam levels auto 10\nunset surface\nset table $lines\nsplot $field using 1:2:3 notitle\n"
         << "unset table\nunset contour\nset surface\n"
         << "$outline << END\n0 0\n"
         << a << " 0\n"
         << a << ' ' << b << "\n0 " << b << "\n0 0\nEND\n"
         << "plot $field using 1:2:3 with image notitle, $lines using 1:2 with lines lw 0.7 lc rgb 'white' notitle, "
         << "$outline using 1:2 with lines lw 1.5 lc rgb 'black' notitle";
  for (std::size_t k = 0; k < map.marks.size(); ++k) {
    if (map.marks[k].points.empty()) continue;
    script << ", $marks" << k << " using 1:2 with points pt " << map.marks[k].symbol << " ps " << 1.4 * map.marks[k].size
           << " lc rgb 'white' notitle, $marks" << k << " using 1:2 with points pt " << map.marks[k].symbol << " ps " << map.marks[k].size
           << " lc rgb '#d1495b' title " << gnuplot_text(map.marks[k].name);
  }
  script << '\n';
  return script.str();
}

core::Status draw_map(const PlateMap& map, const std::string& file) { return draw(map_script(map), file); }

namespace {

/// Returns the style of curve number `k`; curves differ also in black and white.
std::string style_of(CurveStyle style, std::size_t k) {
  switch (style) {
    case CurveStyle::LinesPoints: return "linespoints lw 2 pt " + std::to_string(k + 4) + " dt " + std::to_string(k + 1);
    case CurveStyle::Lines: return "lines lw 2";
    case CurveStyle::Points: return "points pt 7 ps 1.2 lc rgb '#d1495b'";
  }
  return "lines";
}

}  // namespace

core::Status draw_curves(const CurvePlot& plot, const std::string& file) {
  std::ostringstream script;
  script.precision(9);
  script << "set title " << gnuplot_text(plot.title) << " noenhanced\nset xlabel " << gnuplot_text(plot.x_label) << "\nset ylabel "
         << gnuplot_text(plot.y_label) << "\nset key below\nset grid\n"
         << (plot.is_from_zero ? "set yrange [0:*]\n" : "");
  for (std::size_t k = 0; k < plot.curves.size(); ++k) {
    script << "$curve" << k << " << END\n";
    for (const auto& [x, y] : plot.curves[k].points) script << x << ' ' << y << '\n';
    script << "END\n";
  }
  script << "plot ";
  for (std::size_t k = 0; k < plot.curves.size(); ++k) {
    script << (k == 0 ? "" : ", ") << "$curve" << k << " using 1:2 with " << style_of(plot.curves[k].style, k) << " title "
           << gnuplot_text(plot.curves[k].name);
  }
  script << '\n';
  return draw(script.str(), file);
}

Marks support_marks(const physics::Plate& plate, const physics::Support& support) {
  constexpr int kSquare = 5;
  Marks marks{.name = "support", .symbol = kSquare, .points = {}};
  if (support.kind == physics::SupportKind::Corner) {
    for (const core::Millimetres y : {support.inset, plate.b - support.inset}) {
      for (const core::Millimetres x : {support.inset, plate.a - support.inset}) marks.points.push_back({x, y});
    }
    return marks;
  }
  constexpr int kPerEdge = 12;
  for (int k = 0; k <= kPerEdge; ++k) {
    const double part = static_cast<double>(k) / kPerEdge;
    for (const double side : {0.0, 1.0}) {
      marks.points.push_back({plate.a * side, plate.b * part});
      if (support.kind != physics::SupportKind::XEdges) marks.points.push_back({plate.a * part, plate.b * side});
    }
  }
  return marks;
}

}  // namespace dts::lab
