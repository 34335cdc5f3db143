// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/result.h"
#include "device/registry.h"
#include "device/sim/scene.h"

namespace dts::device::sim {

/// `sim:floor`: a person, weights or spacers on the plate of `context.rig`. Fails when an option is wrong, a file cannot be read or
/// what it asks for does not fit.
[[nodiscard]] core::Result<std::unique_ptr<Device>> create_floor(const DeviceUri& uri, const DeviceContext& context);

/// What stands before the converter of `sim:floor`, for those who bring a converter of their own: emulated DAQs.
struct FloorScene {
  std::unique_ptr<Scene> scene;
  std::size_t sensors = 0;   ///< The first values of a scan, V.
  std::size_t channels = 0;  ///< All values; the last three are true_ml_mm, true_ap_mm and true_load_n unless truth=0 was asked for.
};

/// The scene that the options of a `sim:floor` URI describe; options of clock, converter and faults have no effect. `rig` must
/// outlive it. Fails as `create_floor`.
[[nodiscard]] core::Result<FloorScene> floor_scene(const DeviceUri& uri, const physics::RigModel& rig);

}  // namespace dts::device::sim
