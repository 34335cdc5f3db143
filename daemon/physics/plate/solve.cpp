// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/solve.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "physics/plate/karman.h"
#include "physics/plate/supported_plate.h"

namespace dts::physics {

class PlateSolution::Field {
 public:
  Field(std::shared_ptr<const Discretisation> discretisation, Eigen::VectorXd dofs)
      : discretisation_(std::move(discretisation)), dofs_(std::move(dofs)) {}

  [[nodiscard]] double deflection_mm(Point point) const { return 1e3 * SupportedPlate::read(dofs_, discretisation_->reading(point)); }

 private:
  std::shared_ptr<const Discretisation> discretisation_;
  Eigen::VectorXd dofs_;
};

PlateSolution::PlateSolution(std::shared_ptr<const Field> field) : field_(std::move(field)) {}

double PlateSolution::deflection_mm(Point point) const { return field_->deflection_mm(point); }

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kLargestForceN = 1e6;  // far beyond any load of a person; rejects typing errors

std::unique_ptr<const Discretisation> discretise(const PlateCase& plate_case, PlateMethod method, int divisions) {
  if (method == PlateMethod::Fem) return make_fem(plate_case.plate, divisions);
  return make_fdm(plate_case.plate, plate_case.support, divisions);
}

core::Status check_load(const Plate& plate, const PlateLoad& load, const std::string& name) {
  const auto& [centre, width, height] = load.area;
  if (!(width.value >= 0.0 && height.value >= 0.0)) {
    return core::fail(core::ErrorCode::InvalidArgument, name + ": a side of its area is negative or not a number");
  }
  for (const double sign : {-0.5, 0.5}) {
    DTS_TRY(check_on_plate(plate, {centre.x + width * sign, centre.y + height * sign}, name));
  }
  if (std::abs(load.force.value) <= kLargestForceN && load.force.value != 0.0) return {};
  return core::fail(core::ErrorCode::InvalidArgument, name + ": a force of " + std::to_string(load.force.value) +
                                                          " N is not allowed: it must be other than 0 and at most 1000000 N");
}

/// Solves on one grid, without error estimates.
core::Result<PlateSolution> solve_on(const PlateCase& plate_case, PlateMethod method, const SolveOptions& options, int divisions) {
  DTS_TRY_ASSIGN(auto supported, SupportedPlate::create(discretise(plate_case, method, divisions), plate_case.plate, plate_case.support));
  const Discretisation& discretisation = supported.discretisation();
  Weights loads;
  for (const auto& [area, force] : plate_case.loads) {
    const bool is_point = area.width.value == 0.0 && area.height.value == 0.0;
    auto weights = discretisation.force(area);
    if (is_point && options.spreads_point_loads) weights = spread_by_simpson(discretisation.grid(), weights);
    for (const auto& [dof, share] : weights) loads.push_back({dof, share * force.value});
  }
  Eigen::VectorXd dofs;
  Eigen::VectorXd unbalanced_n = supported.whole(loads);
  int load_steps = 1;
  int newton_iterations = 0;
  if (options.is_nonlinear) {
    DTS_TRY_ASSIGN(auto state, bend_and_stretch(supported, plate_case.plate, supported.vector(loads), options.report_progress));
    dofs = std::move(state.dofs);
    unbalanced_n -= state.membrane_n;
    load_steps = state.load_steps;
    newton_iterations = state.newton_iterations;
  } else {
    dofs = supported.bend(supported.vector(loads));
  }
  unbalanced_n -= supported.forces_n(dofs);
  PlateSolution solution(std::make_shared<PlateSolution::Field>(supported.shared_discretisation(), std::move(dofs)));
  solution.reactions_n = supported.reactions_n(unbalanced_n);
  solution.load_steps = load_steps;
  solution.newton_iterations = newton_iterations;
  for (const Point& probe : plate_case.probes) solution.probes.push_back({solution.deflection_mm(probe), kNan});
  return solution;
}

}  // namespace

core::Result<PlateMethod> parse_plate_method(std::string_view name) {
  if (name == "fdm") return PlateMethod::Fdm;
  if (name == "fem") return PlateMethod::Fem;
  return core::fail(core::ErrorCode::InvalidArgument, "unknown plate method '" + std::string(name) + "'", "use fdm or fem");
}

int default_divisions(PlateMethod method, bool is_nonlinear) noexcept {
  if (method == PlateMethod::Fdm) return is_nonlinear ? 40 : 120;
  return is_nonlinear ? 24 : 40;
}

core::Status check(const PlateCase& plate_case, PlateMethod method, const SolveOptions& options) {
  DTS_TRY(check_plate(plate_case.plate));
  DTS_TRY(check_support(plate_case.plate, plate_case.support));
  const int most = options.is_nonlinear ? kMostNonlinearDivisions : Grid::kMaxDivisions;
  DTS_TRY(check_divisions(options.divisions, Grid::kMinDivisions, most));
  if (method == PlateMethod::Fem && options.spreads_point_loads) {
    return core::fail(core::ErrorCode::InvalidArgument, "Simpson's load of thesis eq. 3.13 works only with the finite differences",
                      "use method fdm, or a patch load");
  }
  if (plate_case.loads.empty()) return core::fail(core::ErrorCode::InvalidArgument, "there is no load", "add at least one load");
  for (std::size_t k = 0; k < plate_case.loads.size(); ++k) {
    DTS_TRY(check_load(plate_case.plate, plate_case.loads[k], "load " + std::to_string(k + 1)));
  }
  for (std::size_t k = 0; k < plate_case.probes.size(); ++k) {
    DTS_TRY(check_on_plate(plate_case.plate, plate_case.probes[k], "probe " + std::to_string(k + 1)));
  }
  return {};
}

core::Result<PlateSolution> solve(const PlateCase& plate_case, PlateMethod method, const SolveOptions& options) {
  DTS_TRY(check(plate_case, method, options));
  auto solution = solve_on(plate_case, method, options, options.divisions);
  const int half = options.divisions / 2;
  if (!solution || half < Grid::kMinDivisions) return solution;
  SolveOptions coarse_options = options;
  coarse_options.report_progress = nullptr;
  const auto coarse = solve_on(plate_case, method, coarse_options, half);
  if (!coarse) return solution;  // a grid too coarse for this case says nothing about the error
  // Thesis eq. 3.11 prints w0 - w1; Richardson's rule, which its 3.12 cites, extrapolates from the finer of the two. An odd number of
  // divisions cannot be halved exactly, so the ratio of the spacings is used.
  const double ratio = static_cast<double>(options.divisions) / half;
  for (std::size_t k = 0; k < solution->probes.size(); ++k) {
    const double difference_mm = coarse->probes[k].deflection_mm - solution->probes[k].deflection_mm;
    solution->probes[k].error_estimate_mm = difference_mm / (ratio * ratio - 1.0);
  }
  return solution;
}

}  // namespace dts::physics
