// SPDX-License-Identifier: Apache-2.0
#include "lab/thesis/point_response.h"

#include <utility>

namespace dts::lab::thesis {

core::Result<PointResponse> PointResponse::create(const physics::Plate& plate, const physics::Support& support,
                                                  std::span<const physics::Point> sensors, physics::PlateMethod method, int divisions) {
  PointResponse response;
  for (const physics::Point& sensor : sensors) {
    const physics::PlateCase plate_case{
        .plate = plate, .support = support, .loads = {{.area = {.centre = sensor}, .force = {1.0}}}, .probes = {}};
    DTS_TRY_ASSIGN(auto solution, physics::solve(plate_case, method, {.divisions = divisions}));
    response.under_unit_load_.push_back(std::move(solution));
  }
  return response;
}

std::vector<double> PointResponse::deflection_mm(physics::Point load, core::Newtons force) const {
  std::vector<double> deflection_mm;
  for (const physics::PlateSolution& solution : under_unit_load_) deflection_mm.push_back(force.value * solution.deflection_mm(load));
  return deflection_mm;
}

}  // namespace dts::lab::thesis
