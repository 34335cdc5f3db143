// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/result.h"
#include "device/sim/chair/chair_options.h"
#include "device/sim/chair/emg.h"
#include "device/sim/scene.h"
#include "physics/rig_model.h"
#include "sim/seat_plate.h"

namespace dts::device::sim {

/// A person on the chair, with the voltages of the sensors:
///
///     cues -> SeatedPerson -> seat load -> SeatPlate -> gap -> sensor curve -> gain -> volts -> sensor faults
///                 +-> Emg
class ChairScene final : public Scene {
 public:
  /// Creates the scene. `rig` must outlive it. Fails if its plate cannot be a seat.
  [[nodiscard]] static core::Result<std::unique_ptr<Scene>> create(const ChairOptions& options, const physics::RigModel& rig);

  [[nodiscard]] core::Status load() override { return {}; }
  void restart() override { person_.emplace(options_.person); }
  void hear(double time_s, const Cue& cue) noexcept override;
  void evaluate(double time_s, std::span<double> values) noexcept override;

 private:
  struct Sensor {
    const physics::SensorCurve* curve = nullptr;
    double unloaded_gap_mm = 0.0;
    double gain = 1.0;
    double drift_per_s = 0.0;
  };

  ChairScene(const ChairOptions& options, const physics::RigModel& rig, dts::sim::SeatPlate plate);
  void write_sensors(double time_s, std::span<double> values) const noexcept;
  void break_sensors(double time_s, std::span<double> values) const noexcept;

  ChairOptions options_;
  double depth_mm_;
  dts::sim::SeatPlate plate_;
  std::vector<Sensor> sensors_;
  std::vector<double> deflection_mm_;
  Emg emg_;
  std::optional<dts::sim::SeatedPerson> person_;
};

}  // namespace dts::device::sim
