// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/result.h"
#include "device/registry.h"

namespace dts::device::sim {

/// `sim:floor`: a person, weights or spacers on the plate of `context.rig`. Fails when an option is wrong, a file cannot be read or
/// what it asks for does not fit.
[[nodiscard]] core::Result<std::unique_ptr<Device>> create_floor(const DeviceUri& uri, const DeviceContext& context);

}  // namespace dts::device::sim
