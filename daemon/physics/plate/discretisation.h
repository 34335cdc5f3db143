// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "physics/plate/grid.h"
#include "physics/plate/plate.h"

// Internal to `solve`, `InfluenceTable` and `StiffeningPlate`; public only for tests. What each plate method provides.

namespace dts::physics {

/// One summand of the stiffness matrix; summands with the same indices add up. Eigen assembles from the accessors without a copy.
struct StiffnessEntry {
  int row_index = 0;
  int column_index = 0;
  double n_per_m = 0.0;

  [[nodiscard]] int row() const noexcept { return row_index; }
  [[nodiscard]] int col() const noexcept { return column_index; }
  [[nodiscard]] double value() const noexcept { return n_per_m; }
};

/// A point at which the stretching of a cell is evaluated: slopes of the deflection and gradients of the in-plane displacements.
struct MembranePoint {
  double area_m2 = 0.0;
  std::vector<double> slope_x_per_m;  ///< One per degree of freedom of `Discretisation::cell_dofs`.
  std::vector<double> slope_y_per_m;
  std::array<double, 4> gradient_x_per_m;  ///< One per corner node of the cell: (i, j), (i+1, j), (i, j+1), (i+1, j+1).
  std::array<double, 4> gradient_y_per_m;
};

/// A plate divided into cells. The degrees of freedom are lengths (deflections in m, slopes times the spacing), so that nodal forces are
/// newtons and the matrix is well scaled.
class Discretisation {
 public:
  virtual ~Discretisation() = default;

  [[nodiscard]] const Grid& grid() const noexcept { return grid_; }
  [[nodiscard]] int dofs_per_node() const noexcept { return dofs_per_node_; }
  [[nodiscard]] int dof_count() const noexcept { return dofs_per_node_ * grid_.node_count(); }

  /// Returns K in: nodal forces = K * degrees of freedom, with free edges; the caller adds the supports. Symmetric, positive semi-definite.
  [[nodiscard]] virtual std::vector<StiffnessEntry> stiffness() const = 0;
  /// Returns which degrees of freedom of node (i, j) a support along an edge holds: one flag per degree of freedom.
  [[nodiscard]] virtual std::array<bool, 4> held_dofs(SupportKind kind, int i, int j) const = 0;
  /// Returns the weights that sum the degrees of freedom to the deflection at a point.
  [[nodiscard]] virtual Weights reading(Point point) const = 0;
  /// Returns the nodal forces of 1 N spread evenly over the part of `patch` that is on the plate.
  [[nodiscard]] virtual Weights force(const Patch& patch) const = 0;
  /// Returns the degrees of freedom of the cell with lower left node (i, j), in the order of MembranePoint's slopes.
  [[nodiscard]] virtual std::vector<int> cell_dofs(int i, int j) const = 0;
  /// Returns the membrane points, which are the same in every cell.
  [[nodiscard]] virtual std::vector<MembranePoint> membrane_points() const = 0;

 protected:
  Discretisation(const Grid& grid, int dofs_per_node) : grid_(grid), dofs_per_node_(dofs_per_node) {}

 private:
  Grid grid_;
  int dofs_per_node_;
};

/// Energy finite differences; see fdm.cpp.
[[nodiscard]] std::unique_ptr<Discretisation> make_fdm(const Plate& plate, const Support& support, int divisions);
/// Conforming bicubic elements; see fem.cpp.
[[nodiscard]] std::unique_ptr<Discretisation> make_fem(const Plate& plate, int divisions);

/// Spreads nodal `weights` (FDM) by (1 4 1)/6 in both directions (thesis eq. 3.13). Weights that would fall off the plate stay on its edge.
[[nodiscard]] Weights spread_by_simpson(const Grid& grid, const Weights& weights);

}  // namespace dts::physics
