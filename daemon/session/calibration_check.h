// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "device/device.h"
#include "pipeline/rig_config.h"

namespace dts::session {

/// Compares what a rig's calibration of the centre of pressure and its sensor curves say about their origin with the rig and its device.
/// Returns warnings with what to do: of the calibration first, then one for all curves with the same difference. The age
/// of a calibration without a difference is compared with 180 days. None if the device replays a recording; none of curves or of age if it
/// is simulated. `report`: on the unit that is open now. If a unit has no serial number, units are not compared.
[[nodiscard]] std::vector<std::string> calibration_warnings(const pipeline::RigConfig& config, const device::DeviceDescription& described,
                                                            const device::DeviceReport& report, std::int64_t now_utc_ns);

}  // namespace dts::session
