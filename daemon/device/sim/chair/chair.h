// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/result.h"
#include "device/device_entry.h"
#include "sim/seated_person.h"

namespace dts::device::sim {

/// Creates `sim:chair`: a person who performs the reaching task on the chair of `context.rig`. Fails if an option is wrong or the rig's
/// plate cannot be a seat.
[[nodiscard]] core::Result<std::unique_ptr<Device>> create_chair(const DeviceUri& uri, const DeviceContext& context);

/// Returns the person that the options of a `sim:chair` URI describe, to predict the reaches. Fails as `create_chair`.
[[nodiscard]] core::Result<dts::sim::SeatedPersonOptions> chair_person(const DeviceUri& uri, const physics::RigModel& rig);

}  // namespace dts::device::sim
