// SPDX-License-Identifier: Apache-2.0
#include "device/sim/loaded_plate.h"

#include <algorithm>

#include "physics/plate/influence_table.h"

namespace dts::device::sim {

core::Result<LoadedPlate> LoadedPlate::create(const FloorOptions& options, const physics::RigModel& rig,
                                              std::span<const physics::Patch> patches) {
  std::vector<physics::Point> probes;
  for (std::size_t i = 0; i < options.sensors; ++i) probes.push_back(rig.sensors[i].position);
  LoadedPlate plate;
  plate.deflection_mm_.resize(probes.size());
  if (options.is_plate_stiffening) {
    DTS_TRY_ASSIGN(auto stiffening, physics::StiffeningPlate::create(rig.plate, rig.support, probes));
    for (const physics::Patch& patch : patches) plate.footprints_.push_back(stiffening.footprint(patch));
    plate.stiffening_ = std::move(stiffening);
    plate.restart();
    return plate;
  }
  DTS_TRY_ASSIGN(const auto table, physics::InfluenceTable::create(rig.plate, rig.support, probes));
  for (const physics::Patch& patch : patches) {
    std::vector<double>& row = plate.mm_per_n_.emplace_back();
    for (std::size_t i = 0; i < probes.size(); ++i) row.push_back(table.under_patch_mm_per_n(i, patch));
  }
  return plate;
}

void LoadedPlate::restart() {
  if (stiffening_) state_ = stiffening_->flat();
}

std::span<const double> LoadedPlate::bend(std::size_t first_patch, std::span<const double> force_n) noexcept {
  if (stiffening_) {
    stiffening_->deflect(std::span(footprints_).subspan(first_patch, force_n.size()), force_n, state_, deflection_mm_);
    return deflection_mm_;
  }
  std::ranges::fill(deflection_mm_, 0.0);
  for (std::size_t k = 0; k < force_n.size(); ++k) {
    const std::vector<double>& row = mm_per_n_[first_patch + k];
    for (std::size_t i = 0; i < row.size(); ++i) deflection_mm_[i] += force_n[k] * row[i];
  }
  return deflection_mm_;
}

}  // namespace dts::device::sim
