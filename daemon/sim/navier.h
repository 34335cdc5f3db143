// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "physics/plate/plate.h"

namespace dts::sim {

/// Deflection at one point of a plate with four simply supported edges, under pressure on a rectangle with fixed x limits: Navier's series,
/// summed over x once. For smooth loads the error falls with the fifth power of the number of terms, so that the result is a reference for
/// the grid methods.
class NavierStrip {
 public:
  static constexpr int kDefaultTerms = 121;

  /// `plate` must have passed check_plate. Pressure beyond the plate's edges has no effect.
  NavierStrip(const physics::Plate& plate, physics::Point probe, core::Millimetres from_x, core::Millimetres to_x,
              int terms = kDefaultTerms);

  /// Returns the deflection under 1 Pa between two depths. Thread: any. Realtime-safe: yes.
  [[nodiscard]] double mm_per_pa(core::Millimetres from_y, core::Millimetres to_y) const noexcept;

 private:
  double depth_mm_;
  std::vector<double> coefficients_;  ///< One per n, mm/Pa.
};

/// Returns the deflection in mm under 1 N on `patch`; the frame carries the part of the force beyond an edge.
[[nodiscard]] double navier_mm_per_n(const physics::Plate& plate, physics::Point probe, const physics::Patch& patch,
                                     int terms = NavierStrip::kDefaultTerms);

}  // namespace dts::sim
