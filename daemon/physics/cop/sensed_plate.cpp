// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/sensed_plate.h"

namespace dts::physics {
namespace {

std::vector<double> deflections(const InfluenceTable& plate, std::span<const PlateLoad> loads) {
  std::vector<double> sum_mm(plate.probe_count());
  for (std::size_t probe = 0; probe < sum_mm.size(); ++probe) {
    for (const PlateLoad& load : loads) sum_mm[probe] += load.force.value * plate.under_patch_mm_per_n(probe, load.area);
  }
  return sum_mm;
}

std::vector<double> deflections(const StiffeningPlate& plate, std::span<const PlateLoad> loads) {
  std::vector<StiffeningPlate::Footprint> footprints;
  std::vector<double> force_n;
  for (const PlateLoad& load : loads) {
    footprints.push_back(plate.footprint(load.area));
    force_n.push_back(load.force.value);
  }
  std::vector<double> deflection_mm(plate.probe_count());
  auto state = plate.flat();
  plate.deflect(footprints, force_n, state, deflection_mm);
  return deflection_mm;
}

}  // namespace

core::Result<SensedPlate> SensedPlate::create(const RigModel& rig, PlateBehaviour behaviour, int divisions) {
  std::vector<Point> probes;
  for (const SensorModel& sensor : rig.sensors) probes.push_back(sensor.position);
  if (behaviour == PlateBehaviour::Stiffening) {
    DTS_TRY_ASSIGN(const auto plate, StiffeningPlate::create(rig.plate, rig.support, probes, divisions));
    return SensedPlate(plate);
  }
  DTS_TRY_ASSIGN(const auto table, InfluenceTable::create(rig.plate, rig.support, probes, divisions));
  return SensedPlate(table);
}

std::vector<double> SensedPlate::deflection_mm(std::span<const PlateLoad> loads) const {
  return std::visit([loads](const auto& plate) { return deflections(plate, loads); }, plate_);
}

std::vector<double> SensedPlate::deflection_mm(Point position, core::Newtons load) const {
  const PlateLoad point{.area = {position, {}, {}}, .force = load};
  return deflection_mm(std::span(&point, 1));
}

}  // namespace dts::physics
