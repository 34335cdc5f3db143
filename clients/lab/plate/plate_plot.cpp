// SPDX-License-Identifier: Apache-2.0
#include "lab/plate/plate_plot.h"

#include <array>

namespace dts::lab::plate {
namespace {

using physics::Point;

constexpr int kTriangle = 11;
constexpr int kCircle = 7;

}  // namespace

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

}  // namespace dts::lab::plate
