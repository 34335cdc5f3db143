// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "core/result.h"
#include "device/sim/cop_recording.h"
#include "device/sim/floor_options.h"
#include "device/sim/loaded_plate.h"
#include "device/sim/scene.h"
#include "device/sim/sensor_bank.h"
#include "sim/standing_person.h"
#include "sim/sway.h"

namespace dts::device::sim {

/// A person or one weight on the floor platform, with the voltages of the sensors:
///
///     sway or recording -> person -> patch forces -> plate deflection -> gap -> sensor curve -> gain -> volts
class PersonScene final : public Scene {
 public:
  /// Time from both feet on the plate to the first row of a recording.
  static constexpr double kSettleS = 0.5;

  /// Creates the scene. `rig` must outlive it. Fails if the stance does not fit on the plate, the recording cannot be read or the plate
  /// cannot be solved.
  [[nodiscard]] static core::Result<std::unique_ptr<Scene>> create(const FloorOptions& options, const physics::RigModel& rig);

  [[nodiscard]] core::Status load() override;
  void restart() override;
  void evaluate(double time_s, std::span<double> values) noexcept override;

 private:
  PersonScene(const FloorOptions& options, const physics::RigModel& rig, const dts::sim::StandingPerson& person, LoadedPlate plate)
      : options_(options), rig_(rig), person_(person), plate_(std::move(plate)), sensors_(options, rig) {}

  [[nodiscard]] dts::sim::CopPosition wanted_cop(double time_s) noexcept;

  FloorOptions options_;
  const physics::RigModel& rig_;
  dts::sim::StandingPerson person_;
  LoadedPlate plate_;
  SensorBank sensors_;
  std::optional<CopRecording> recording_;
  std::optional<dts::sim::Sway> sway_;
};

}  // namespace dts::device::sim
