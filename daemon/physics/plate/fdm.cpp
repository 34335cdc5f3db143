// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <utility>

#include "physics/plate/discretisation.h"

// Energy finite differences (plate-model section 2): the bending energy is a sum of squares of difference quotients. The free-edge
// conditions M_n = 0, V_n = 0 and w_xy = 0 at the corners follow automatically, so neither ghost nodes nor boundary rows are needed. The
// interior row is D/l^2 (20, -8, 2, 1), the 13-point stencil of thesis eq. 3.10.

namespace dts::physics {
namespace {

/// A difference quotient: sum of weight * deflection over a few nodes.
template <std::size_t Size>
struct Stencil {
  std::array<int, Size> nodes;
  std::array<double, Size> weights;
};

template <std::size_t RowSize, std::size_t ColumnSize>
void add_product(std::vector<StiffnessEntry>& entries, double factor, const Stencil<RowSize>& a, const Stencil<ColumnSize>& b) {
  for (std::size_t row = 0; row < RowSize; ++row) {
    for (std::size_t column = 0; column < ColumnSize; ++column) {
      entries.push_back({a.nodes[row], b.nodes[column], factor * a.weights[row] * b.weights[column]});
    }
  }
}

template <std::size_t Size>
void add_square(std::vector<StiffnessEntry>& entries, double factor, const Stencil<Size>& stencil) {
  add_product(entries, factor, stencil, stencil);
}

Stencil<3> second_difference_x(const Grid& grid, int i, int j) {
  const double scale = 1.0 / (grid.dx_m * grid.dx_m);
  return {{grid.node(i - 1, j), grid.node(i, j), grid.node(i + 1, j)}, {scale, -2.0 * scale, scale}};
}

Stencil<3> second_difference_y(const Grid& grid, int i, int j) {
  const double scale = 1.0 / (grid.dy_m * grid.dy_m);
  return {{grid.node(i, j - 1), grid.node(i, j), grid.node(i, j + 1)}, {scale, -2.0 * scale, scale}};
}

Stencil<4> mixed_difference(const Grid& grid, int i, int j) {
  const double scale = 1.0 / (grid.dx_m * grid.dy_m);
  return {{grid.node(i, j), grid.node(i + 1, j), grid.node(i, j + 1), grid.node(i + 1, j + 1)}, {scale, -scale, -scale, scale}};
}

/// Adds the bending energy of the piece of plate around a node. Along a free edge, M_n = 0 determines the curvature across it, which leaves
/// 1 - nu^2 of the curvature along it; a corner node bends in neither direction.
void add_bending(std::vector<StiffnessEntry>& entries, const Plate& plate, const Grid& grid, int i, int j) {
  const bool is_on_x_edge = i == 0 || i == grid.divisions;
  const bool is_on_y_edge = j == 0 || j == grid.divisions;
  const double cell = plate.rigidity_nm() * grid.dx_m * grid.dy_m;
  const double edge_factor = 0.5 * cell * (1.0 - plate.nu * plate.nu);
  if (is_on_x_edge && is_on_y_edge) return;
  if (is_on_y_edge) return add_square(entries, edge_factor, second_difference_x(grid, i, j));
  if (is_on_x_edge) return add_square(entries, edge_factor, second_difference_y(grid, i, j));
  const auto wxx = second_difference_x(grid, i, j);
  const auto wyy = second_difference_y(grid, i, j);
  add_square(entries, cell, wxx);
  add_square(entries, cell, wyy);
  add_product(entries, cell * plate.nu, wxx, wyy);
  add_product(entries, cell * plate.nu, wyy, wxx);
}

/// A clamped edge has no slope: the node beyond it mirrors the node before it, so the curvature across the edge is twice their difference.
/// The edge's own deflection is included although it is held, because the forces of a shifted plate must still sum to zero.
void add_clamped_edges(std::vector<StiffnessEntry>& entries, const Plate& plate, const Grid& grid) {
  const double half_cell = 0.5 * plate.rigidity_nm() * grid.dx_m * grid.dy_m;
  const double across_x = 2.0 / (grid.dx_m * grid.dx_m);
  const double across_y = 2.0 / (grid.dy_m * grid.dy_m);
  const int last = grid.divisions;
  for (int k = 1; k < last; ++k) {
    for (const int edge : {0, last}) {
      const int inner = edge == 0 ? 1 : last - 1;
      add_square(entries, half_cell, Stencil<2>{{grid.node(inner, k), grid.node(edge, k)}, {across_x, -across_x}});
      add_square(entries, half_cell, Stencil<2>{{grid.node(k, inner), grid.node(k, edge)}, {across_y, -across_y}});
    }
  }
}

std::vector<StiffnessEntry> free_plate_stiffness(const Plate& plate, const Grid& grid) {
  constexpr std::size_t kEntriesPerNode = 9 + 9 + 9 + 9 + 16;
  std::vector<StiffnessEntry> entries;
  entries.reserve(kEntriesPerNode * static_cast<std::size_t>(grid.node_count()));
  for (int j = 0; j <= grid.divisions; ++j) {
    for (int i = 0; i <= grid.divisions; ++i) add_bending(entries, plate, grid, i, j);
  }
  const double twist = 2.0 * (1.0 - plate.nu) * plate.rigidity_nm() * grid.dx_m * grid.dy_m;
  for (int j = 0; j < grid.divisions; ++j) {
    for (int i = 0; i < grid.divisions; ++i) add_square(entries, twist, mixed_difference(grid, i, j));
  }
  return entries;
}

/// Returns the weights of the nodes for a tensor product of line weights.
Weights product(const Grid& grid, const Weights& columns, const Weights& lines) {
  Weights nodes;
  nodes.reserve(columns.size() * lines.size());
  for (const auto& [j, line] : lines) {
    for (const auto& [i, column] : columns) nodes.push_back({grid.node(i, j), line * column});
  }
  return nodes;
}

class Fdm final : public Discretisation {
 public:
  Fdm(const Plate& plate, const Support& support, const Grid& grid)
      : Discretisation(grid, 1), plate_(plate), is_clamped_(support.kind == SupportKind::Clamped) {}

  [[nodiscard]] std::vector<StiffnessEntry> stiffness() const override {
    auto entries = free_plate_stiffness(plate_, grid());
    if (is_clamped_) add_clamped_edges(entries, plate_, grid());
    return entries;
  }

  [[nodiscard]] std::array<bool, 4> held_dofs(SupportKind kind, int i, int j) const override {
    if (kind == SupportKind::Corner) return {};
    return {grid().is_on_x_edge(i) || (kind != SupportKind::XEdges && grid().is_on_y_edge(j))};
  }

  /// Cubic, because near a clamped edge a parabola between nodes would have a larger error than the solution itself.
  [[nodiscard]] Weights reading(Point point) const override {
    const int divisions = grid().divisions;
    return product(grid(), cubic_weights(stretch_on_axis(point.x.value, 0.0, grid().dx_mm(), divisions).from, divisions),
                   cubic_weights(stretch_on_axis(point.y.value, 0.0, grid().dy_mm(), divisions).from, divisions));
  }

  [[nodiscard]] Weights force(const Patch& patch) const override {
    const int divisions = grid().divisions;
    return product(grid(), linear_weights(stretch_on_axis(patch.centre.x.value, patch.width.value, grid().dx_mm(), divisions), divisions),
                   linear_weights(stretch_on_axis(patch.centre.y.value, patch.height.value, grid().dy_mm(), divisions), divisions));
  }

  [[nodiscard]] std::vector<int> cell_dofs(int i, int j) const override {
    return {grid().node(i, j), grid().node(i + 1, j), grid().node(i, j + 1), grid().node(i + 1, j + 1)};
  }

  /// Returns one point at each corner of the cell, with the differences along the two cell sides that meet there.
  [[nodiscard]] std::vector<MembranePoint> membrane_points() const override {
    const double dx_m = grid().dx_m;
    const double dy_m = grid().dy_m;
    std::vector<MembranePoint> points;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const std::size_t row = corner & 2U;
      const std::size_t column = corner & 1U;
      MembranePoint point{.area_m2 = 0.25 * dx_m * dy_m, .gradient_x_per_m = {}, .gradient_y_per_m = {}};
      point.gradient_x_per_m[row] = -1.0 / dx_m;
      point.gradient_x_per_m[row + 1] = 1.0 / dx_m;
      point.gradient_y_per_m[column] = -1.0 / dy_m;
      point.gradient_y_per_m[column + 2] = 1.0 / dy_m;
      point.slope_x_per_m.assign(point.gradient_x_per_m.begin(), point.gradient_x_per_m.end());
      point.slope_y_per_m.assign(point.gradient_y_per_m.begin(), point.gradient_y_per_m.end());
      points.push_back(std::move(point));
    }
    return points;
  }

 private:
  Plate plate_;
  bool is_clamped_;
};

}  // namespace

std::unique_ptr<Discretisation> make_fdm(const Plate& plate, const Support& support, int divisions) {
  return std::make_unique<Fdm>(plate, support, Grid::over(plate, divisions));
}

Weights spread_by_simpson(const Grid& grid, const Weights& weights) {
  constexpr std::array<double, 3> kSimpson = {1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};
  const auto inside = [&](int line) { return std::clamp(line, 0, grid.divisions); };
  Weights spread;
  for (const auto& [node, weight] : weights) {
    const int i = node % (grid.divisions + 1);
    const int j = node / (grid.divisions + 1);
    for (int dj = -1; dj <= 1; ++dj) {
      for (int di = -1; di <= 1; ++di) {
        const double share = kSimpson[static_cast<std::size_t>(di + 1)] * kSimpson[static_cast<std::size_t>(dj + 1)];
        spread.push_back({grid.node(inside(i + di), inside(j + dj)), weight * share});
      }
    }
  }
  return spread;
}

}  // namespace dts::physics
