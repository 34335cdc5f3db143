// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/grid.h"

#include <algorithm>
#include <array>

#include "physics/conversions.h"

namespace dts::physics {
namespace {

void add(Weights& weights, int index, double value) {
  if (value == 0.0) return;
  const auto found = std::ranges::find(weights, index, &Weight::index);
  if (found != weights.end()) {
    found->value += value;
  } else {
    weights.push_back({index, value});
  }
}

}  // namespace

Grid Grid::over(const Plate& plate, int divisions) noexcept {
  return {divisions, plate.a.value / kMillimetresPerMetre / divisions, plate.b.value / kMillimetresPerMetre / divisions};
}

Stretch stretch_on_axis(double centre_mm, double length_mm, double spacing_mm, int divisions) noexcept {
  const double half = 0.5 * std::max(length_mm, 0.0) / spacing_mm;
  const double centre = centre_mm / spacing_mm;
  const double end = divisions;
  return {std::clamp(centre - half, 0.0, end), std::clamp(centre + half, 0.0, end)};
}

void spread(LineWeights& lines, Stretch stretch, int divisions) noexcept {
  const int first_cell = std::min(static_cast<int>(stretch.from), divisions - 1);
  const int last_cell = std::min(static_cast<int>(stretch.to), divisions - 1);
  lines.first = static_cast<std::size_t>(first_cell);
  lines.count = static_cast<std::size_t>(last_cell - first_cell) + 2;
  if (stretch.is_point()) {
    lines.count = 2;
    lines.weight[1] = stretch.from - first_cell;
    lines.weight[0] = 1.0 - lines.weight[1];
    return;
  }
  const double length = stretch.to - stretch.from;
  std::fill_n(lines.weight.begin(), lines.count, 0.0);
  for (int cell = first_cell; cell <= last_cell; ++cell) {
    const double s = std::max(stretch.from - cell, 0.0);
    const double t = std::min(stretch.to - cell, 1.0);
    const double right = 0.5 * (t * t - s * s) / length;
    const auto k = static_cast<std::size_t>(cell - first_cell);
    lines.weight[k] += (t - s) / length - right;
    lines.weight[k + 1] += right;
  }
}

Weights linear_weights(Stretch stretch, int divisions) {
  LineWeights lines;
  spread(lines, stretch, divisions);
  Weights weights;
  for (std::size_t k = 0; k < lines.count; ++k) weights.push_back({static_cast<int>(lines.first + k), lines.weight[k]});
  return weights;
}

Weights cubic_weights(double at, int divisions) {
  const int cell = std::min(static_cast<int>(at), divisions - 1);
  const double s = at - cell;
  const std::array<double, 4> lagrange = {-s * (s - 1.0) * (s - 2.0) / 6.0, (s + 1.0) * (s - 1.0) * (s - 2.0) / 2.0,
                                          -(s + 1.0) * s * (s - 2.0) / 2.0, (s + 1.0) * s * (s - 1.0) / 6.0};
  Weights weights;
  for (int k = 0; k < 4; ++k) {
    const int line = cell - 1 + k;
    const double weight = lagrange[static_cast<std::size_t>(k)];
    if (line >= 0 && line <= divisions) {
      add(weights, line, weight);
      continue;
    }
    const int end = line < 0 ? 0 : divisions;  // a parabola through the last three lines
    const int inward = line < 0 ? 1 : -1;
    add(weights, end, 3.0 * weight);
    add(weights, end + inward, -3.0 * weight);
    add(weights, end + 2 * inward, weight);
  }
  return weights;
}

}  // namespace dts::physics
