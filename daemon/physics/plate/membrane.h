// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "physics/plate/discretisation.h"

// Internal to the non-linear solvers (Eigen in its interface): how the middle plane of a plate stretches.

namespace dts::physics {

/// Computes membrane strains (xx, yy, engineering xy) at the points of every cell from deflection and in-plane displacements. Unknowns of a
/// cell: the degrees of freedom of its deflection, then u, v of its four nodes.
class Membrane {
 public:
  Membrane(const Discretisation& discretisation, const Plate& plate);

  using Strain = Eigen::Vector3d;
  /// Maps strains to forces per width: E h / (1 - nu^2) times plane stress.
  [[nodiscard]] const Eigen::Matrix3d& elasticity() const noexcept { return elasticity_; }

  /// Coefficients at one point of a cell: the slopes, and the part of the strain that is linear in u and v.
  struct Point {
    double area_m2 = 0.0;
    Eigen::RowVectorXd slope_x;
    Eigen::RowVectorXd slope_y;
    Eigen::Matrix<double, 3, 8> in_plane;
  };
  [[nodiscard]] const std::vector<Point>& points() const noexcept { return points_; }

  /// In-plane unknowns: u at 2 * node, v at 2 * node + 1.
  [[nodiscard]] int in_plane_count() const noexcept { return 2 * grid_.node_count(); }
  [[nodiscard]] std::array<int, 8> in_plane_dofs(int i, int j) const;
  /// Fixed so that the plate can neither move nor rotate in its plane; they carry no force.
  [[nodiscard]] std::array<int, 3> pinned_dofs() const;

 private:
  Grid grid_;
  Eigen::Matrix3d elasticity_;
  std::vector<Point> points_;
};

}  // namespace dts::physics
