// SPDX-License-Identifier: Apache-2.0
#include "lab/base/thesis_setup.h"

#include <string>

namespace dts::lab::thesis_setup {

physics::RigModel floor_platform() {
  physics::RigModel rig{.plate = steel(), .support = kSteelSupport, .sensors = {}};
  for (const double y_mm : {kSensorMm, kFarSensorMm}) {
    for (const double x_mm : {kSensorMm, kFarSensorMm}) {
      rig.sensors.push_back({.label = "w" + std::to_string(rig.sensors.size() + 1),
                             .position = {{x_mm}, {y_mm}},
                             .curve = physics::SensorCurve::hoa1405_assumed()});
    }
  }
  return rig;
}

}  // namespace dts::lab::thesis_setup
