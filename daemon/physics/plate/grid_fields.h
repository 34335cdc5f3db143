// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "physics/plate/grid.h"

namespace dts::physics {

/// Scalar fields with values at the nodes of one grid, bilinear between the nodes. Immutable. Thread: any. Realtime-safe: yes.
class GridFields {
 public:
  GridFields() = default;
  explicit GridFields(const Grid& grid) : divisions_(grid.divisions), dx_mm_(grid.dx_mm()), dy_mm_(grid.dy_mm()) {}

  /// `nodes`: one value per node of the grid.
  void add(std::vector<double> nodes) { fields_.push_back(std::move(nodes)); }
  [[nodiscard]] std::size_t size() const noexcept { return fields_.size(); }
  /// Returns the mean of a field over the part of `patch` on the plate, exact for the bilinear field. A patch with a side of length 0 is a
  /// line or a point. A patch off the plate counts as the nearest edge. Returns NaN if a number is not finite or the field does not exist.
  [[nodiscard]] double mean(std::size_t field, const Patch& patch) const noexcept;

 private:
  int divisions_ = 1;
  double dx_mm_ = 1.0;
  double dy_mm_ = 1.0;
  std::vector<std::vector<double>> fields_;
};

}  // namespace dts::physics
