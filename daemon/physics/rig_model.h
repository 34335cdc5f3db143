// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/units.h"
#include "physics/force_plate/force_plate.h"
#include "physics/plate/plate.h"
#include "physics/sensor_curve.h"

namespace dts::physics {

/// One displacement sensor under the plate.
struct SensorModel {
  std::string label;  ///< "w1"
  Point position;     ///< Plate coordinates, corner origin.
  SensorCurve curve;  ///< Output voltage over the gap between sensor and plate.
  core::Millimetres unloaded_gap{12.0};
  SensorCurveOrigin curve_origin{};  ///< Empty for a curve that was written by hand.
};

/// A force plate of another maker that is wired to the rig's DAQ.
struct ForcePlateModel {
  ForcePlate plate;
  std::vector<std::string> channel_names;  ///< "fx12", one for each channel of the plate.
  Mounting mounting{};
  std::optional<PointPolynomial> polynomial{};  ///< In the plate's axes; absent: the point is not corrected.
  std::vector<double> tare_v;                   ///< Volts of the unloaded plate, by channel; a tare at work replaces them.
};

/// The physical model of one rig: the simulator bends it, and the estimators are calibrated on it.
/// A force plate has no sensors and no support; of `plate`, only the sides of its surface apply: a along ML, b along AP.
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
  std::optional<ForcePlateModel> force_plate{};
};

/// Returns the names of the rig's inputs, in order: the labels of its sensors, or the channels of its force plate.
[[nodiscard]] std::vector<std::string> input_names(const RigModel& rig);

}  // namespace dts::physics
