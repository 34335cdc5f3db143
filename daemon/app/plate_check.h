// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/config.h"

namespace dts::app {

/// Returns a warning for every floor rig whose plate model is invalid: a person on one foot bends the plate by more than
/// `physics::StiffeningPlate` can model. Then simulated volts are wrong, and so is a centre of pressure without the rig's own calibration.
/// A rig with its own calibration on a real device needs no plate model. Each warning has the position of the rig's device in the file.
[[nodiscard]] files::Problems plate_warnings(const DaemonConfig& config);

}  // namespace dts::app
