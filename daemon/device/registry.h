// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "device/device_entry.h"

namespace dts::device {

/// All kinds of devices in this program. A new kind needs one folder and one entry in registry.cpp.
[[nodiscard]] const std::vector<RegistryEntry>& registry();

/// Returns true if both URIs may open the same unit: same kind of hardware, and equal serial numbers or one of them missing.
[[nodiscard]] bool compete(std::string_view one_uri, std::string_view other_uri);

/// Parses `uri` and creates the device, in state Closed. Errors name the URI, the unknown kind or option, and the known ones.
[[nodiscard]] core::Result<std::unique_ptr<Device>> create_device(std::string_view uri, const DeviceContext& context);

}  // namespace dts::device
