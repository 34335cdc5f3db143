// SPDX-License-Identifier: Apache-2.0
#include "lab/plate_plot.h"

#include <array>

namespace dts::lab {
namespace {

using physics::Point;
using physics::SupportKind;

constexpr int kSquare = 5;
constexpr int kTriangle = 11;
constexpr int kCircle = 7;

}  // namespace

Marks support_marks(const physics::Plate& plate, const physics::Support& support) {
  Marks marks{.name = "support", .symbol = kSquare, .points = {}};
  if (support.kind == SupportKind::Corner) {
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
      if (support.kind != SupportKind::XEdges) marks.points.push_back({plate.a * part, plate.b * side});
    }
  }
  return marks;
}

core::Status plot_plate(const physics::PlateCase& plate_case, const physics::PlateSolution& solution, const std::string& file) {
  Marks loads{.name = "load", .symbol = kTriangle, .size = 2.4, .points = {}};
  std::vector<physics::Patch> patches;
  for (const physics::PlateLoad& load : plate_case.loads) {
    const bool is_patch = load.area.width.value > 0.0 || load.area.height.value > 0.0;
    if (is_patch) {
      patches.push_back(load.area);
    } else {
      loads.points.push_back(load.area.centre);
    }
  }
  const physics::Plate& plate = plate_case.plate;
  return draw_map({.title = "Deflection of the plate",
                   .quantity = "deflection (mm)",
                   .from = {},
                   .to = {plate.a, plate.b},
                   .value = [&](Point at) { return solution.deflection_mm(at); },
                   .marks = {support_marks(plate, plate_case.support),
                             loads,
                             {.name = "probe", .symbol = kCircle, .size = 1.1, .points = plate_case.probes}},
                   .patches = patches,
                   .plate = plate},
                  file);
}

}  // namespace dts::lab
