// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

namespace dts::bench {

/// The classic non-conforming rectangle of Adini, Clough and Melosh (12 terms; w, w_x, w_y at each node), as a peer: what most
/// hand-written plate codes use. Node k of a cell: (0,0), (1,0), (1,1), (0,1) times (dx, dy).
class NonconformingElement {
 public:
  using Terms = Eigen::Matrix<double, 12, 1>;
  using Stiffness = Eigen::Matrix<double, 12, 12>;

  NonconformingElement(double dx_m, double dy_m, double rigidity_nm, double nu) {
    Stiffness at_nodes;
    const std::array<std::array<double, 2>, 4> corners = {{{0, 0}, {dx_m, 0}, {dx_m, dy_m}, {0, dy_m}}};
    for (int k = 0; k < 4; ++k) {
      const auto [x, y] = corners[static_cast<std::size_t>(k)];
      at_nodes.row(3 * k) = value(x, y);
      at_nodes.row(3 * k + 1) << 0, 1, 0, 2 * x, y, 0, 3 * x * x, 2 * x * y, y * y, 0, 3 * x * x * y, y * y * y;
      at_nodes.row(3 * k + 2) << 0, 0, 1, 0, x, 2 * y, 0, x * x, 2 * x * y, 3 * y * y, x * x * x, 3 * x * y * y;
    }
    terms_of_dofs_ = at_nodes.inverse();
    Eigen::Matrix3d elasticity;
    elasticity << 1, nu, 0, nu, 1, 0, 0, 0, (1 - nu) / 2;
    const std::array<double, 3> places = {0.5 - 0.3872983346207417, 0.5, 0.5 + 0.3872983346207417};
    const std::array<double, 3> weights = {5.0 / 18, 8.0 / 18, 5.0 / 18};
    stiffness_.setZero();
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        const double x = places[i] * dx_m;
        const double y = places[j] * dy_m;
        Eigen::Matrix<double, 3, 12> curvature;  // w_xx, w_yy, 2 w_xy
        curvature.row(0) << 0, 0, 0, 2, 0, 0, 6 * x, 2 * y, 0, 0, 6 * x * y, 0;
        curvature.row(1) << 0, 0, 0, 0, 0, 2, 0, 0, 2 * x, 6 * y, 0, 6 * x * y;
        curvature.row(2) << 0, 0, 0, 0, 2, 0, 0, 4 * x, 4 * y, 0, 6 * x * x, 6 * y * y;
        const auto change = (curvature * terms_of_dofs_).eval();
        stiffness_ += weights[i] * weights[j] * dx_m * dy_m * rigidity_nm * change.transpose() * elasticity * change;
      }
    }
  }

  [[nodiscard]] const Stiffness& stiffness() const { return stiffness_; }
  /// Weight of each degree of freedom in the deflection at (x, y) of the cell, m.
  [[nodiscard]] Terms reading(double x_m, double y_m) const { return terms_of_dofs_.transpose() * value(x_m, y_m).transpose(); }

 private:
  [[nodiscard]] static Eigen::Matrix<double, 1, 12> value(double x, double y) {
    Eigen::Matrix<double, 1, 12> terms;
    terms << 1, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y, x * x * x * y, x * y * y * y;
    return terms;
  }

  Stiffness terms_of_dofs_;
  Stiffness stiffness_;
};

}  // namespace dts::bench
