// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "physics/plate/grid.h"

namespace dts::physics {

/// Scalar fields given at the nodes of one grid, bilinear between them. Immutable. Thread: any. Realtime-safe: yes.
class GridFields {
 public:
  GridFields() = default;
  explicit GridFields(const Grid& grid) : divisions_(grid.divisions), dx_mm_(grid.dx_mm()), dy_mm_(grid.dy_mm()) {}

  /// `nodes`: one value per node of the grid.
  void add(std::vector<double> nodes) { fields_.push_back(std::move(nodes)); }
  [[nodiscard]] std::size_t size() const noexcept { return fields_.size(); }
  /// Mean of a field over the part of a patch that lies on the plate, exact for the bilinear field; a side of no length makes it a line
  /// or a point, and what lies off the plate counts as its nearest edge. NaN when a number is not finite or there is no such field.
  [[nodiscard]] double mean(std::size_t field, const Patch& patch) const noexcept;

 private:
  int divisions_ = 1;
  double dx_mm_ = 1.0;
  double dy_mm_ = 1.0;
  std::vector<std::vector<double>> fields_;
};

}  // namespace dts::physics
