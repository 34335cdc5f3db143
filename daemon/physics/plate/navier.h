// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "physics/plate/plate.h"

namespace dts::physics {

/// Deflection at one point of a plate with all four edges simply supported, under pressure on a rectangle whose sides in x are fixed: the
/// series of Navier, summed over x once. For smooth loads it converges as the fifth power of the terms: exact where grids err.
class NavierStrip {
 public:
  static constexpr int kDefaultTerms = 121;

  /// `plate` has passed check_plate. What lies beyond the plate's edges presses on nothing.
  NavierStrip(const Plate& plate, Point probe, core::Millimetres from_x, core::Millimetres to_x, int terms = kDefaultTerms);

  /// Under 1 Pa between these depths. Thread: any. Realtime-safe: yes.
  [[nodiscard]] double mm_per_pa(core::Millimetres from_y, core::Millimetres to_y) const noexcept;

 private:
  double depth_mm_;
  std::vector<double> coefficients_;  ///< Per n, mm/Pa.
};

/// Under 1 N on all of `patch`, of which the part beyond an edge rests on the frame: mm.
[[nodiscard]] double navier_mm_per_n(const Plate& plate, Point probe, const Patch& patch, int terms = NavierStrip::kDefaultTerms);

}  // namespace dts::physics
