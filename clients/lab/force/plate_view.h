// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "lab/force/force_file.h"

namespace dts::lab::force {

/// From the axes of a plate to those of the laboratory: x = c1 - c2, z = x cross (c1 - c4), y = z cross x, normalised.
struct PlatePlace {
  std::array<Vector, 3> axes{};  ///< The plate's x, y and z in the laboratory.
  Vector centre_mm{};            ///< Mean of the four corners.

  [[nodiscard]] Vector turned(const Vector& of_plate) const noexcept;
};

/// Returns nothing if the corners are missing or do not span a plane.
[[nodiscard]] std::optional<PlatePlace> place_of(const PlateFacts& plate);

/// Shows the samples of one plate in the axes that are asked for, without a COP and a free moment where the vertical force is less than
/// `least_force_n`. The file and its plate must outlive it.
class PlateView {
 public:
  /// In the axes of the laboratory, all samples of a plate without corners are empty.
  PlateView(const ForceFile& file, std::size_t plate, Axes axes, double least_force_n);

  [[nodiscard]] ForceSample at(std::size_t sample) const;
  /// Returns a sample that counts for means: the vertical force is known and large enough, or the file has a COP only.
  [[nodiscard]] std::optional<ForceSample> loaded_at(std::size_t sample) const;

 private:
  [[nodiscard]] bool is_loaded(const ForceSample& of_file) const noexcept;
  [[nodiscard]] ForceSample in_axes(ForceSample of_file) const;

  const ForceFile* file_;
  std::size_t plate_;
  double least_force_n_;
  bool is_turned_;
  std::optional<PlatePlace> place_;
};

}  // namespace dts::lab::force
