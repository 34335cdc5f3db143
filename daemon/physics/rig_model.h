// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/units.h"
#include "physics/plate/plate.h"
#include "physics/sensor_curve.h"

namespace dts::physics {

/// One displacement sensor under the plate.
struct SensorModel {
  std::string label;  ///< "w1"
  Point position;     ///< Plate coordinates, corner origin.
  SensorCurve curve;  ///< Output voltage over the gap between sensor and plate.
  core::Millimetres unloaded_gap{12.0};
};

/// The physical model of one rig: the simulator bends it, and the estimators are calibrated on it.
/// Floor platform: sensors in the order w1 (-,-), w2 (+,-), w3 (-,+), w4 (+,+) of plate-model section 3.
struct RigModel {
  Plate plate;
  Support support;
  std::vector<SensorModel> sensors;
  /// Chair: sensors that form the transient, the rear ones (smaller y) first; each pair is symmetric to the middle (thesis 5.3.2).
  struct TransientSensors {
    std::array<std::size_t, 2> rear{};  ///< Indices into `sensors`: left, right.
    std::array<std::size_t, 2> front{};
  };
  std::optional<TransientSensors> transient_sensors{};
};

}  // namespace dts::physics
