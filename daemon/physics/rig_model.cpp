// SPDX-License-Identifier: Apache-2.0
#include "physics/rig_model.h"

namespace dts::physics {

std::vector<std::string> input_names(const RigModel& rig) {
  if (rig.force_plate) return rig.force_plate->channel_names;
  std::vector<std::string> names;
  for (const SensorModel& sensor : rig.sensors) names.push_back(sensor.label);
  return names;
}

}  // namespace dts::physics
