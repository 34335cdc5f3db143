// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/config.h"

namespace dts::app {

/// Warns of every floor rig whose plate model does not hold: under a person on one foot it bends by more than `physics::StiffeningPlate`
/// can follow, so that simulated volts and a centre of pressure without a calibration of the rig's own are wrong. A rig with its own
/// calibration on a real device needs no plate model. Each warning has the place of the rig's device.
[[nodiscard]] files::Problems plate_warnings(const DaemonConfig& config);

}  // namespace dts::app
