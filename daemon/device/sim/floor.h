// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/result.h"
#include "device/device_entry.h"
#include "device/sim/scene.h"

namespace dts::device::sim {

/// Creates `sim:floor`: a person or weights on the plate of `context.rig`, or spacers in front of its sensors. Fails if an option is
/// wrong, a file cannot be read or its content does not fit the rig.
[[nodiscard]] core::Result<std::unique_ptr<Device>> create_floor(const DeviceUri& uri, const DeviceContext& context);

/// The scene of `sim:floor` without its converter, for emulated DAQs, which have their own converter.
struct FloorScene {
  std::unique_ptr<Scene> scene;
  std::size_t sensors = 0;   ///< Number of sensors: the first values of a scan, V.
  std::size_t channels = 0;  ///< Number of all values; the last three are true_ml_mm, true_ap_mm and true_load_n, unless truth=0.
};

/// Returns the scene that the options of a `sim:floor` URI describe; options of clock, converter and faults have no effect. `rig` must
/// outlive the scene. Fails as `create_floor`.
[[nodiscard]] core::Result<FloorScene> floor_scene(const DeviceUri& uri, const physics::RigModel& rig);

}  // namespace dts::device::sim
