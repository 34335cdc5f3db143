// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "core/result.h"
#include "device/sim/floor_options.h"
#include "device/sim/loaded_plate.h"
#include "device/sim/placement.h"
#include "device/sim/scene.h"
#include "device/sim/sensor_bank.h"
#include "device/sim/weight_list.h"

namespace dts::device::sim {

/// Known weights on the plate, one after the other, to calibrate the platform.
class WeightsScene final : public Scene {
 public:
  /// Creates the scene and reads the list of weights. `rig` must outlive the scene.
  [[nodiscard]] static core::Result<std::unique_ptr<Scene>> create(const FloorOptions& options, const physics::RigModel& rig);

  [[nodiscard]] core::Status load() override { return {}; }
  void restart() override { plate_.restart(); }
  void evaluate(double time_s, std::span<double> values) noexcept override;

 private:
  WeightsScene(const FloorOptions& options, const physics::RigModel& rig, std::vector<Weight> weights, LoadedPlate plate)
      : times_(options.placement), rig_(rig), weights_(std::move(weights)), plate_(std::move(plate)), sensors_(options, rig) {}

  PlacementTimes times_;
  const physics::RigModel& rig_;
  std::vector<Weight> weights_;
  LoadedPlate plate_;
  SensorBank sensors_;
};

/// Spacers of known height, with a target, in front of every sensor, to calibrate the sensors. Without a spacer a sensor measures the far
/// end of its curve. The plate does not bend.
class GapsScene final : public Scene {
 public:
  /// Creates the scene. `rig` must outlive it. Fails if a gap is outside a sensor's curve.
  [[nodiscard]] static core::Result<std::unique_ptr<Scene>> create(const FloorOptions& options, const physics::RigModel& rig);

  [[nodiscard]] core::Status load() override { return {}; }
  void restart() override {}
  void evaluate(double time_s, std::span<double> values) noexcept override;

 private:
  GapsScene(const FloorOptions& options, const physics::RigModel& rig)
      : times_(options.placement), gaps_mm_(options.gaps_mm), sensors_(options, rig) {}

  PlacementTimes times_;
  std::vector<double> gaps_mm_;
  SensorBank sensors_;
};

}  // namespace dts::device::sim
