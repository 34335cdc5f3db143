// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/grid_fields.h"

#include <cmath>
#include <limits>

namespace dts::physics {

double GridFields::mean(std::size_t field, const Patch& patch) const noexcept {
  const double all = patch.centre.x.value + patch.centre.y.value + patch.width.value + patch.height.value;
  if (field >= fields_.size() || !std::isfinite(all)) return std::numeric_limits<double>::quiet_NaN();
  LineWeights columns;
  LineWeights lines;
  spread(columns, stretch_on_axis(patch.centre.x.value, patch.width.value, dx_mm_, divisions_), divisions_);
  spread(lines, stretch_on_axis(patch.centre.y.value, patch.height.value, dy_mm_, divisions_), divisions_);
  const double* values = fields_[field].data();
  double mean = 0.0;
  for (std::size_t j = 0; j < lines.count; ++j) {
    const double* nodes = values + (lines.first + j) * static_cast<std::size_t>(divisions_ + 1) + columns.first;
    double line = 0.0;
    for (std::size_t i = 0; i < columns.count; ++i) line += columns.weight[i] * nodes[i];
    mean += lines.weight[j] * line;
  }
  return mean;
}

}  // namespace dts::physics
