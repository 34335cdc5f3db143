// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/result.h"
#include "device/sim/cop_recording.h"
#include "device/sim/floor_options.h"
#include "device/sim/scene.h"
#include "physics/rig_model.h"
#include "physics/standing_person.h"
#include "physics/sway.h"

namespace dts::device::sim {

/// A person or a weight on the floor platform, down to the sensors' voltages:
///
///     sway or recording -> person -> patch forces -> plate deflection -> gap -> sensor curve -> gain -> volts
///
/// The plate is linear, so each sensor needs one number per patch, computed once. Values: sensors, extra channels, then
/// true_ml_mm, true_ap_mm, true_load_n when asked for.
class FloorScene final : public Scene {
 public:
  /// From both feet on the plate to the first row of a recording.
  static constexpr double kSettleS = 0.5;

  /// `rig` must outlive the scene. Fails when the stance does not fit on the plate or the plate cannot be solved.
  [[nodiscard]] static core::Result<std::unique_ptr<FloorScene>> create(const FloorOptions& options, const physics::RigModel& rig);

  [[nodiscard]] core::Status load() override;
  void restart() override;
  void evaluate(double time_s, std::span<double> values) noexcept override;

 private:
  struct Sensor {
    const physics::SensorCurve* curve = nullptr;
    double unloaded_gap_mm = 0.0;
    double gain = 1.0;
    std::array<double, physics::kMaxContacts> mm_per_n{};  ///< Deflection under 1 N on each patch.
  };

  FloorScene(const FloorOptions& options, const physics::RigModel& rig, const physics::StandingPerson& person)
      : options_(options), rig_(rig), person_(person) {}

  [[nodiscard]] core::Status place_sensors();
  [[nodiscard]] physics::CopPosition wanted_cop(double time_s) noexcept;

  FloorOptions options_;
  const physics::RigModel& rig_;
  physics::StandingPerson person_;
  std::vector<Sensor> sensors_;
  std::optional<CopRecording> recording_;
  std::optional<physics::Sway> sway_;
};

}  // namespace dts::device::sim
