// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/result.h"
#include "device/device.h"

namespace dts::device {

/// `wanted`, when it is within the limits of `description`; else InvalidArgument with the limits.
[[nodiscard]] core::Result<core::Rate> check_rate(const DeviceDescription& description, core::Rate wanted);

/// Rate and block size within what this device and the house can do.
[[nodiscard]] core::Status check_start(const DeviceDescription& description, const StartOptions& options);

/// The answer of `set_sync_output` of a device without such a line, in each state.
[[nodiscard]] core::Status refuse_sync_output(const DeviceDescription& description, DeviceState state);

}  // namespace dts::device
