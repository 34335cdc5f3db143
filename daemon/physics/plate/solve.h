// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "physics/plate/plate.h"

namespace dts::physics {

/// Two independent discretisations of the same plate: where they agree, the result is trustworthy; where they differ, one is in error.
enum class PlateMethod : std::uint8_t {
  Fdm,  ///< Energy finite differences, thesis 3.3 made symmetric (plate-model section 2).
  Fem,  ///< Conforming bicubic rectangle of Bogner, Fox and Schmit: w, w_x, w_y, w_xy at every node.
};

/// Parses "fdm" or "fem"; fails with InvalidArgument for anything else.
[[nodiscard]] core::Result<PlateMethod> parse_plate_method(std::string_view name);

/// A force spread evenly over a patch; a patch of size 0 is a point load.
struct PlateLoad {
  Patch area;
  core::Newtons force;
};

struct PlateCase {
  Plate plate;
  Support support;
  std::vector<PlateLoad> loads;
  std::vector<Point> probes;
};

/// Returns the divisions of each side at which both methods are within 0.2 % away from a point load and 0.5 % under it, for every support
/// (measured in tests/unit/physics/plate/unseen_plates_test.cpp). A non-linear solution then needs one or two seconds.
[[nodiscard]] int default_divisions(PlateMethod method, bool is_nonlinear) noexcept;
inline constexpr int kMostNonlinearDivisions = 80;

struct SolveOptions {
  int divisions = 40;         ///< Of each side, 4..200; at most kMostNonlinearDivisions for a non-linear solution.
  bool is_nonlinear = false;  ///< Von Karman: the plate stiffens as it stretches; supports slide freely in the plane.
  /// Thesis eq. 3.13: spreads a point load over the neighbouring nodes by Simpson's weights (1 4 1)/6 in both directions. Fdm only.
  bool spreads_point_loads = false;
  std::function<void(double)> report_progress;  ///< Non-linear solutions call it from time to time with 0..1.
};

/// The result at one probe.
struct ProbeResult {
  double deflection_mm = 0.0;  ///< Positive along the load.
  /// Richardson's estimate of the error of `deflection_mm` from a second solution with half the divisions (thesis eq. 3.11 and 3.12,
  /// corrected: finer plus a third of the difference). Fdm: subtract the estimate to extrapolate. Fem: the estimate is too large away from
  /// point loads, because Fem converges there with the fourth order. NaN if there is no coarser grid.
  double error_estimate_mm = 0.0;
};

/// A solved plate. Immutable. Thread: any.
class PlateSolution {
 public:
  /// The deflection field on one grid, evaluated anywhere on the plate.
  class Field;

  std::vector<ProbeResult> probes;
  /// Forces on the supports, positive against the load. Corner: the supports (-,-), (+,-), (-,+), (+,+). Edges and Clamped: the edges
  /// x = 0, x = a, y = 0, y = b; corner nodes are shared evenly. XEdges: the edges x = 0, x = a. Their sum equals the sum of the loads.
  std::vector<double> reactions_n;
  int load_steps = 1;         ///< Of a non-linear solution.
  int newton_iterations = 0;  ///< Of a non-linear solution.

  [[nodiscard]] double deflection_mm(Point point) const;

  explicit PlateSolution(std::shared_ptr<const Field> field);

 private:
  std::shared_ptr<const Field> field_;
};

/// Fails with InvalidArgument if a value of the case is out of range (the message names the value and its range), if there are no loads, or
/// if the supports do not hold the plate. A patch must lie completely on the plate.
[[nodiscard]] core::Status check(const PlateCase& plate_case, PlateMethod method, const SolveOptions& options);
/// Fails as `check`, and if a non-linear solution does not converge.
[[nodiscard]] core::Result<PlateSolution> solve(const PlateCase& plate_case, PlateMethod method, const SolveOptions& options = {});

}  // namespace dts::physics
