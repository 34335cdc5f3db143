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

/// The rig's plate with all patches that anything will ever touch: made once, so that bending it takes no memory.
class LoadedPlate {
 public:
  /// Probes are the first `options.sensors` sensors of the rig. Fails as the plate's own `create`.
  [[nodiscard]] static core::Result<LoadedPlate> create(const FloorOptions& options, const physics::RigModel& rig,
                                                        std::span<const physics::Patch> patches);

  /// Flat again, as before the first scan.
  void restart();
  /// Deflection of every sensor, mm, under `force_n[k]` on patch `first_patch + k`; valid until the next call. Realtime-safe: yes.
  [[nodiscard]] std::span<const double> bend(std::size_t first_patch, std::span<const double> force_n) noexcept;

 private:
  LoadedPlate() = default;

  std::vector<double> deflection_mm_;
  std::vector<std::vector<double>> mm_per_n_;           ///< Linear plate: per patch, per sensor.
  std::optional<physics::StiffeningPlate> stiffening_;  ///< The other kind, with a footprint per patch.
  std::vector<physics::StiffeningPlate::Footprint> footprints_;
  physics::StiffeningPlate::State state_;
};

}  // namespace dts::device::sim
