// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/result.h"
#include "physics/plate/plate.h"

namespace dts::physics {

/// The von Karman plate, small enough to be bent anew for every scan.
///
/// The full linear deflection (influence rows) plus a non-linear correction in a few smooth shapes, whose in-plane stretching is
/// condensed out exactly when the plate is made. What it is worth is measured in tests/unit/physics/plate/stiffening_plate_test.cpp.
class StiffeningPlate {
 public:
  /// Deflection, in thicknesses of the plate, up to which this is accurate; beyond it, only `solve` is.
  static constexpr double kMostThicknesses = 2.5;

  /// One contact patch, reduced to what 1 N on it does.
  struct Footprint {
    std::vector<double> probe_mm_per_n;         ///< Linear deflection of every probe.
    std::vector<double> shape_m_per_amplitude;  ///< Its work on every shape: generalised force per newton.
  };
  /// Where the last scan left the plate, and under what load: the next one goes on from there. A new one is flat and unloaded.
  struct State {
    std::vector<double> amplitude;
    std::vector<double> force;
  };

  /// As InfluenceTable::create.
  [[nodiscard]] static core::Result<StiffeningPlate> create(const Plate& plate, const Support& support, std::span<const Point> probes,
                                                            int divisions = 40);

  [[nodiscard]] std::size_t probe_count() const noexcept;
  [[nodiscard]] Footprint footprint(const Patch& patch) const;
  [[nodiscard]] State flat() const;
  /// Deflection of every probe under `force_n[k]` on `footprints[k]`. All of the plate's own making; sizes equal. A small
  /// change of the load is followed from the last call's equilibrium; any other load is put down on the flat plate in small steps (some
  /// ten for a body weight), so that the result does not depend on what was there before.
  /// Thread: one per State. Realtime-safe: yes.
  void deflect(std::span<const Footprint> footprints, std::span<const double> force_n, State& state,
               std::span<double> deflection_mm) const noexcept;
  /// The same for one load; takes memory.
  [[nodiscard]] std::vector<double> deflections_mm(const Patch& patch, core::Newtons force) const;

 private:
  struct Model;
  explicit StiffeningPlate(std::shared_ptr<const Model> model);
  std::shared_ptr<const Model> model_;
};

}  // namespace dts::physics
