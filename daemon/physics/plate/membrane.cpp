// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/membrane.h"

namespace dts::physics {

Membrane::Membrane(const Discretisation& discretisation, const Plate& plate) : grid_(discretisation.grid()) {
  const double stiffness_n_per_m = plate.e_pa * plate.h.value * 1e-3 / (1.0 - plate.nu * plate.nu);
  elasticity_ << 1.0, plate.nu, 0.0, plate.nu, 1.0, 0.0, 0.0, 0.0, 0.5 * (1.0 - plate.nu);
  elasticity_ *= stiffness_n_per_m;
  for (const MembranePoint& from : discretisation.membrane_points()) {
    const auto count = static_cast<Eigen::Index>(from.slope_x_per_m.size());
    Point point{.area_m2 = from.area_m2,
                .slope_x = Eigen::Map<const Eigen::RowVectorXd>(from.slope_x_per_m.data(), count),
                .slope_y = Eigen::Map<const Eigen::RowVectorXd>(from.slope_y_per_m.data(), count),
                .in_plane = Eigen::Matrix<double, 3, 8>::Zero()};
    for (Eigen::Index node = 0; node < 4; ++node) {
      const double dx = from.gradient_x_per_m[static_cast<std::size_t>(node)];
      const double dy = from.gradient_y_per_m[static_cast<std::size_t>(node)];
      point.in_plane(0, 2 * node) = dx;
      point.in_plane(1, 2 * node + 1) = dy;
      point.in_plane(2, 2 * node) = dy;
      point.in_plane(2, 2 * node + 1) = dx;
    }
    points_.push_back(std::move(point));
  }
}

std::array<int, 8> Membrane::in_plane_dofs(int i, int j) const {
  const std::array<int, 4> nodes = {grid_.node(i, j), grid_.node(i + 1, j), grid_.node(i, j + 1), grid_.node(i + 1, j + 1)};
  std::array<int, 8> dofs{};
  for (std::size_t k = 0; k < 4; ++k) {
    dofs[2 * k] = 2 * nodes[k];
    dofs[2 * k + 1] = 2 * nodes[k] + 1;
  }
  return dofs;
}

std::array<int, 3> Membrane::pinned_dofs() const {
  const int left = grid_.node(0, 0);
  const int right = grid_.node(grid_.divisions, 0);
  return {2 * left, 2 * left + 1, 2 * right + 1};
}

}  // namespace dts::physics
