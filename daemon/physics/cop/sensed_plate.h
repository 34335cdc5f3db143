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
  Stiffening,  ///< Von Karman: the behaviour of a real plate under a person.
  Linear,      ///< Only thin-plate theory, as in the thesis.
};

/// Sensor deflections of a rig's plate under known loads; for calibration and evaluation, not for the sample path.
/// Immutable. Thread: any. Realtime-safe: no.
class SensedPlate {
 public:
  [[nodiscard]] static core::Result<SensedPlate> create(const RigModel& rig, PlateBehaviour behaviour,
                                                        int divisions = InfluenceTable::kDefaultDivisions);

  /// Returns the deflection of every sensor under all loads together, mm. Patches off the plate are treated as in InfluenceTable.
  [[nodiscard]] std::vector<double> deflection_mm(std::span<const PlateLoad> loads) const;
  [[nodiscard]] std::vector<double> deflection_mm(Point position, core::Newtons load) const;

 private:
  explicit SensedPlate(InfluenceTable table) : plate_(std::move(table)) {}
  explicit SensedPlate(StiffeningPlate plate) : plate_(std::move(plate)) {}

  std::variant<InfluenceTable, StiffeningPlate> plate_;
};

}  // namespace dts::physics
