// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "core/clock.h"
#include "core/result.h"
#include "device/sim/loaded_plate.h"
#include "device/sim/scene.h"
#include "device/sim/sensor_bank.h"
#include "device/sim/stack/stack_options.h"
#include "device/sim/stack/stack_time.h"
#include "sim/plate_response.h"
#include "sim/stack_person.h"

namespace dts::device::sim {

/// One part of a stack: its inputs, the sync signal and the truth, at true times.
///
///     scan -> device time -> true time -> StackPerson -> Floor: plate deflection -> gaps -> volts
///                                     |              `-> Plate: wrench about its surface -> volts
///                                     `-> sync signal: 5 V for 0.1 s from each whole second
///
/// The person does not begin again when the device does: after a restart, the scene continues at the present true time.
class StackScene final : public Scene {
 public:
  /// Creates the scene. `rig` and `clock` must outlive it. Fails if the stance does not fit on the platform or the plate cannot be solved.
  [[nodiscard]] static core::Result<std::unique_ptr<Scene>> create(const StackOptions& options, const physics::RigModel& rig,
                                                                   const core::Clock& clock);

  [[nodiscard]] core::Status load() override { return {}; }
  /// Computes the person's past until now, 0.1 us per ms and axis, so that the first scan need not.
  void restart() override;
  void set_start(std::int64_t start_ns) override { start_ns_ = start_ns; }
  void evaluate(double time_s, std::span<double> values) noexcept override;

 private:
  /// The floor platform's side; absent for the force plate.
  struct Platform {
    LoadedPlate plate;
    SensorBank sensors;
  };
  StackScene(const StackOptions& options, const core::Clock& clock, const dts::sim::StackPerson& person)
      : options_(options), clock_(clock), time_(StackTime::join(clock, options.seed)), person_(person) {}

  [[nodiscard]] double true_s(std::int64_t start_ns, double time_s) const noexcept;

  StackOptions options_;
  const core::Clock& clock_;
  std::shared_ptr<const StackTime> time_;
  dts::sim::StackPerson person_;
  std::optional<Platform> platform_;
  std::optional<dts::sim::PlateResponse> force_plate_;
  std::int64_t start_ns_ = 0;
};

}  // namespace dts::device::sim
