// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/result.h"
#include "physics/plate/grid_fields.h"
#include "physics/plate/plate.h"

namespace dts::physics {

/// Deflection at fixed probes under any load, from one factorisation. By reciprocity, the deflection at a probe is the load vector times
/// the probe's influence row (energy finite differences, plate-model section 2).
///
/// Deflections are positive along the load, millimetres per newton. Const methods: Thread: any. Realtime-safe: yes.
class InfluenceTable {
 public:
  static constexpr int kDefaultDivisions = 40;  ///< As thesis 3.5.

  /// Solves once per probe. Fails with InvalidArgument if the plate, the support, a probe or `divisions` (4..200) is invalid; the message
  /// names the value and its range.
  [[nodiscard]] static core::Result<InfluenceTable> create(const Plate& plate, const Support& support, std::span<const Point> probes,
                                                           int divisions = kDefaultDivisions);

  [[nodiscard]] std::size_t probe_count() const noexcept { return rows_.size(); }
  /// Returns the deflection at `probe` under 1 N at `load`; a position off the plate counts as the nearest edge. Returns NaN if a
  /// coordinate is not finite or the probe does not exist.
  [[nodiscard]] double at_point_mm_per_n(std::size_t probe, Point load) const noexcept { return rows_.mean(probe, {.centre = load}); }
  /// Returns the deflection at `probe` under 1 N spread evenly over `patch` (the part on the plate carries all of it): the exact mean of
  /// the bilinear interpolation of the row. A patch with a side of length 0 is a line or point load. Returns NaN as `at_point_mm_per_n`.
  [[nodiscard]] double under_patch_mm_per_n(std::size_t probe, const Patch& patch) const noexcept { return rows_.mean(probe, patch); }

 private:
  InfluenceTable() = default;

  GridFields rows_;  ///< One per probe, mm/N.
};

}  // namespace dts::physics
