// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/result.h"
#include "physics/plate/solve.h"

namespace dts::lab::thesis {

/// Deflection of a linear plate at a few sensors under point loads at any position: one solution per sensor, evaluated at the load, because
/// deflection and load can be exchanged (reciprocity).
class PointResponse {
 public:
  [[nodiscard]] static core::Result<PointResponse> create(const physics::Plate& plate, const physics::Support& support,
                                                          std::span<const physics::Point> sensors, physics::PlateMethod method,
                                                          int divisions);

  /// Returns the deflection of every sensor, mm.
  [[nodiscard]] std::vector<double> deflection_mm(physics::Point load, core::Newtons force) const;

 private:
  PointResponse() = default;

  std::vector<physics::PlateSolution> under_unit_load_;
};

}  // namespace dts::lab::thesis
