// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "core/result.h"
#include "core/units.h"
#include "physics/plate/influence_table.h"
#include "physics/plate/solve.h"
#include "physics/plate/stiffening_plate.h"
#include "physics/rig_model.h"

namespace dts::physics {

enum class PlateBehaviour : std::uint8_t {
  Stiffening,  ///< Von Karman: what a real plate does under a person.
  Linear,      ///< Thin-plate theory alone, as in the thesis.
};

/// What a rig's sensors see of its plate under known loads: for calibration and evaluation, not for the sample path.
/// Immutable. Thread: any. Realtime-safe: no.
class SensedPlate {
 public:
  [[nodiscard]] static core::Result<SensedPlate> create(const RigModel& rig, PlateBehaviour behaviour,
                                                        int divisions = InfluenceTable::kDefaultDivisions);

  /// Deflection of every sensor under all loads together, mm. Patches off the plate as InfluenceTable takes them.
  [[nodiscard]] std::vector<double> deflection_mm(std::span<const PlateLoad> loads) const;
  [[nodiscard]] std::vector<double> deflection_mm(Point position, core::Newtons load) const;

 private:
  explicit SensedPlate(InfluenceTable table) : plate_(std::move(table)) {}
  explicit SensedPlate(StiffeningPlate plate) : plate_(std::move(plate)) {}

  std::variant<InfluenceTable, StiffeningPlate> plate_;
};

}  // namespace dts::physics
