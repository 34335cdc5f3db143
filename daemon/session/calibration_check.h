// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "device/device.h"
#include "pipeline/rig_config.h"

namespace dts::session {

/// Compares what a rig's calibration of the centre of pressure says about its origin with the rig and its device, and returns a warning
/// with what to do; empty: no difference, no calibration, or the device replays a recording. `report`: on the unit that is open now. A unit
/// without a serial number is compared by its model only.
[[nodiscard]] std::string calibration_warning(const pipeline::RigConfig& config, const device::DeviceDescription& described,
                                              const device::DeviceReport& report);

}  // namespace dts::session
