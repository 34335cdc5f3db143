// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/result.h"
#include "device/device.h"

namespace dts::device {

/// Returns `wanted` if it is within the limits of `description`; otherwise fails with InvalidArgument, naming the limits.
[[nodiscard]] core::Result<core::Rate> check_rate(const DeviceDescription& description, core::Rate wanted);

/// Checks the rate against the limits of this device, and the block size against the limit of the program.
[[nodiscard]] core::Status check_start(const DeviceDescription& description, const StartOptions& options);

/// Returns the error of `set_sync_output` for a device without a sync line, in each state.
[[nodiscard]] core::Status refuse_sync_output(const DeviceDescription& description, DeviceState state);

}  // namespace dts::device
