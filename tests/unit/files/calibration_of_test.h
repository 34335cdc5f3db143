// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/cop/cop_calibration.h"
#include "physics/cop/cop_evaluation.h"

namespace dts::files {

/// A calibration by the plate model: of 16 sensors for `Moment`, else of the shipped floor's four.
inline physics::CopCalibration calibration_of_test(physics::CopMethod method) {
  physics::RigModel rig{.plate = {}, .support = {.kind = physics::SupportKind::Corner, .inset = {10.75}}, .sensors = {}};
  const bool is_moment = method == physics::CopMethod::Moment;
  const int per_side = is_moment ? 4 : 2;
  const double first_mm = is_moment ? 53.75 : 86.0;
  const double step_mm = is_moment ? 107.5 : 258.0;
  for (int k = 0; k < per_side * per_side; ++k) {
    rig.sensors.push_back(
        {"s", {{first_mm + step_mm * (k % per_side)}, {first_mm + step_mm * (k / per_side)}}, physics::SensorCurve::hoa1405_assumed()});
  }
  const auto samples = physics::model_samples(method, rig, physics::PlateBehaviour::Stiffening).value();
  return physics::calibrate_cop(
             method, samples,
             {.created_utc = "2026-01-31T12:00:00Z", .rig = "floor", .daq_model = "the \"best\"\\one", .daq_serial = "01D2"})
      .value();
}

}  // namespace dts::files
