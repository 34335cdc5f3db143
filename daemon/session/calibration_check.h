// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "device/device.h"
#include "pipeline/rig_config.h"

namespace dts::session {

/// Compares what a rig's calibration of the centre of pressure says about its origin with the rig and its device, and returns a warning
/// with what to do; empty: no difference, no calibration, or the device replays a recording. `serial`: of the unit that is open now; empty:
/// not known.
[[nodiscard]] std::string calibration_warning(const pipeline::RigConfig& config, const device::DeviceDescription& device,
                                              const std::string& serial);

}  // namespace dts::session
