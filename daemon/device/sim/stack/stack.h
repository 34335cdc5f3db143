// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/result.h"
#include "device/device_entry.h"

namespace dts::device::sim {

/// Creates `sim:stack`: one part of a floor platform on a force plate, with one person on both. Fails if an option is wrong or does not fit
/// the rig.
[[nodiscard]] core::Result<std::unique_ptr<Device>> create_stack(const DeviceUri& uri, const DeviceContext& context);

}  // namespace dts::device::sim
