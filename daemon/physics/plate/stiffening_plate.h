// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/result.h"
#include "physics/plate/plate.h"

namespace dts::physics {

/// The von Karman plate, cheap enough to be solved for every scan.
///
/// Adds to the full linear deflection (influence rows) a non-linear correction in a few smooth shapes. The in-plane stretching of the
/// shapes is eliminated exactly when the plate is created. tests/unit/physics/plate/stiffening_plate_test.cpp measures the accuracy.
class StiffeningPlate {
 public:
  /// Largest accurate deflection, in plate thicknesses; beyond it, use `solve`.
  static constexpr double kMostThicknesses = 2.5;

  /// One contact patch, reduced to the effect of 1 N on it.
  struct Footprint {
    std::vector<double> probe_mm_per_n;         ///< Linear deflection at every probe.
    std::vector<double> shape_m_per_amplitude;  ///< Work on every shape: generalised force per newton.
  };
  /// Deflection and load after the last scan; the next scan starts from them. `flat()` is unloaded.
  struct State {
    std::vector<double> amplitude;
    std::vector<double> force;
  };

  /// Fails as InfluenceTable::create.
  [[nodiscard]] static core::Result<StiffeningPlate> create(const Plate& plate, const Support& support, std::span<const Point> probes,
                                                            int divisions = 40);

  [[nodiscard]] std::size_t probe_count() const noexcept;
  [[nodiscard]] Footprint footprint(const Patch& patch) const;
  [[nodiscard]] State flat() const;
  /// Computes the deflection at every probe under `force_n[k]` on `footprints[k]`. Footprints and state must be from this plate; sizes must
  /// be equal. For a small change of the load, starts from the equilibrium of the last call. For any other load, starts from the flat plate
  /// in small steps (about ten for a body weight), so that the result does not depend on earlier loads.
  /// Thread: one per State. Realtime-safe: yes.
  void deflect(std::span<const Footprint> footprints, std::span<const double> force_n, State& state,
               std::span<double> deflection_mm) const noexcept;
  /// Does the same for one load; allocates memory.
  [[nodiscard]] std::vector<double> deflections_mm(const Patch& patch, core::Newtons force) const;

 private:
  struct Model;
  explicit StiffeningPlate(std::shared_ptr<const Model> model);
  std::shared_ptr<const Model> model_;
};

}  // namespace dts::physics
