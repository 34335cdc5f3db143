// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "pipeline/rig_config.h"

namespace dts::session {

/// The floor platform with four sensors at 1500 Hz on a device of the caller's choice.
inline pipeline::RigConfig floor_config(const std::string& device, std::size_t block_scans = 8) {
  pipeline::RigConfig config;
  config.name = "floor";
  config.kind = "floor";
  config.device_uri = device;
  config.model.support.inset = {10.75};
  for (const auto& [x, y] : {std::pair{86.0, 86.0}, {344.0, 86.0}, {86.0, 344.0}, {344.0, 344.0}}) {
    config.sensor_channels.push_back(config.sensor_channels.size());
    config.model.sensors.push_back({.label = "w" + std::to_string(config.sensor_channels.size()),
                                    .position = {.x = {x}, .y = {y}},
                                    .curve = physics::SensorCurve::hoa1405_assumed()});
  }
  config.rate = core::Rate::create(1500, 1).value();
  config.block_scans = block_scans;
  for (const char* id : {"guard", "window_filter", "linearise", "cop"}) config.stages.push_back({.id = id, .options = {}});
  config.published = {"raw", "cop"};
  return config;
}

}  // namespace dts::session
