// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/result.h"
#include "device/sim/floor_options.h"
#include "physics/plate/stiffening_plate.h"
#include "physics/rig_model.h"

namespace dts::device::sim {

/// The rig's plate with all patches that will be loaded: prepared once, so that `bend` does not allocate.
class LoadedPlate {
 public:
  /// Prepares the plate; the probes are the first `options.sensors` sensors of the rig. Fails as `create` of the plate.
  [[nodiscard]] static core::Result<LoadedPlate> create(const FloorOptions& options, const physics::RigModel& rig,
                                                        std::span<const physics::Patch> patches);

  /// Makes the plate flat again, as before the first scan.
  void restart();
  /// Returns the deflection at every sensor, mm, for `force_n[k]` on patch `first_patch + k`; valid until the next call.
  /// Realtime-safe: yes.
  [[nodiscard]] std::span<const double> bend(std::size_t first_patch, std::span<const double> force_n) noexcept;

 private:
  LoadedPlate() = default;

  std::vector<double> deflection_mm_;
  std::vector<std::vector<double>> mm_per_n_;           ///< For the linear plate: per patch and sensor.
  std::optional<physics::StiffeningPlate> stiffening_;  ///< For the stiffening plate, with one footprint per patch.
  std::vector<physics::StiffeningPlate::Footprint> footprints_;
  physics::StiffeningPlate::State state_;
};

}  // namespace dts::device::sim
