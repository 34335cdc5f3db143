// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/result.h"
#include "physics/plate/plate.h"

// Inside of InfluenceTable, open to its tests: the plate as a spring network on a grid of nodes.

namespace dts::physics::energy {

/// Nodes (i, j) at (i dx, j dy), i and j from 0 to `divisions`, numbered row by row.
struct Grid {
  int divisions = 0;
  double dx_m = 0.0;
  double dy_m = 0.0;

  [[nodiscard]] static Grid over(const Plate& plate, int divisions) noexcept;

  [[nodiscard]] int node(int i, int j) const noexcept { return j * (divisions + 1) + i; }
  [[nodiscard]] int node_count() const noexcept { return (divisions + 1) * (divisions + 1); }
  [[nodiscard]] bool is_on_edge(int node) const noexcept;
};

/// One summand of the stiffness matrix; summands of the same place add up.
struct StiffnessEntry {
  int row = 0;
  int column = 0;
  double n_per_m = 0.0;
};

/// Stiffness K of the plate with all edges free: nodal forces = K * nodal deflections. Symmetric, positive semi-definite;
/// its null space is the rigid motions {1, x, y}.
///
/// The bending energy as a sum of squares of difference quotients (plate-model section 2). The free-edge conditions M_n = 0,
/// V_n = 0 and w_xy = 0 at the corners come out by themselves, so there are neither ghost nodes nor boundary rows to code; the
/// interior row is D/l^2 (20, -8, 2, 1), the 13-point stencil of thesis eq. 3.10.
[[nodiscard]] std::vector<StiffnessEntry> free_plate_stiffness(const Plate& plate, const Grid& grid);

/// A point expressed through the four nodes around it; the weights sum to 1. Serves as load, as probe and as support.
struct NodeWeights {
  std::array<int, 4> nodes{};
  std::array<double, 4> weights{};
};
[[nodiscard]] NodeWeights bilinear_weights(const Grid& grid, Point point) noexcept;

/// Deflection of every node under 1 N at each of `points`, m/N: one factorisation, one solution per point. The inputs must have
/// passed the checks of `InfluenceTable::create`. Fails with InvalidArgument when the supports do not hold the plate.
[[nodiscard]] core::Result<std::vector<std::vector<double>>> deflections_under_unit_loads(const Plate& plate, const Support& support,
                                                                                          const Grid& grid, std::span<const Point> points);

}  // namespace dts::physics::energy
