// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "physics/plate/plate.h"

namespace dts::physics {

/// The grid of nodes that both methods use: (i, j) at (i dx, j dy), i and j from 0 to `divisions`, numbered row by row.
struct Grid {
  static constexpr int kMinDivisions = 4;
  static constexpr int kMaxDivisions = 200;

  int divisions = 0;
  double dx_m = 0.0;
  double dy_m = 0.0;

  [[nodiscard]] static Grid over(const Plate& plate, int divisions) noexcept;

  [[nodiscard]] double dx_mm() const noexcept { return 1000.0 * dx_m; }
  [[nodiscard]] double dy_mm() const noexcept { return 1000.0 * dy_m; }
  [[nodiscard]] int node(int i, int j) const noexcept { return j * (divisions + 1) + i; }
  [[nodiscard]] int node_count() const noexcept { return (divisions + 1) * (divisions + 1); }
  [[nodiscard]] bool is_on_x_edge(int i) const noexcept { return i == 0 || i == divisions; }
  [[nodiscard]] bool is_on_y_edge(int j) const noexcept { return j == 0 || j == divisions; }
};

/// An interval on one axis in units of the spacing, 0 <= from <= to <= divisions.
struct Stretch {
  double from = 0.0;
  double to = 0.0;

  [[nodiscard]] bool is_point() const noexcept { return to - from < 1e-9; }
};
/// Returns the part of `centre_mm` +- half `length_mm` that lies on an axis of `divisions` cells of `spacing_mm`.
[[nodiscard]] Stretch stretch_on_axis(double centre_mm, double length_mm, double spacing_mm, int divisions) noexcept;

/// The weight of each grid line of one axis for a load spread evenly over a stretch: the mean of the line's hat function; for a point,
/// linear interpolation. The weights sum to 1.
struct LineWeights {
  std::size_t first = 0;
  std::size_t count = 0;
  std::array<double, Grid::kMaxDivisions + 1> weight;  ///< Only [0, count) is set: clearing all entries would cost more than the sum.
};
/// Realtime-safe: yes.
void spread(LineWeights& lines, Stretch stretch, int divisions) noexcept;

/// One share of a load or of a reading; `index` is a grid line, a node or a degree of freedom, depending on the context.
struct Weight {
  int index = 0;
  double value = 0.0;
};
using Weights = std::vector<Weight>;

/// Returns the weights of `spread` as a list.
[[nodiscard]] Weights linear_weights(Stretch stretch, int divisions);
/// Returns the cubic interpolation at a point from the four lines around it; near an end, extrapolates the missing line.
[[nodiscard]] Weights cubic_weights(double at, int divisions);

}  // namespace dts::physics
