// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/rig_model.h"

namespace dts::sim {

/// Returns the assumed curve of the chair's sensor: V = 0.05 + 4.2 / (1 + (d / 2.5 mm)^2), points every 0.25 mm over 0.5..12 mm. It has the
/// typical decrease of a Vishay CNY70 to 20 % at 5 mm and the slopes of reach-model section 4 (0.68, 0.27, 0.18, 0.12 V/mm at 3, 5, 6, 7
/// mm).
[[nodiscard]] physics::SensorCurve cny70_assumed();

/// Returns the DTS chair as reach-model section 4 proposes it (thesis Fig. 5.2 is lost): an acrylic plate of 400 x 360 x 6 mm, supported at
/// its edges, over 16 sensors in rows of 6, 2, 6, 2 from the rear. Sensors 2, 5, 10 and 13 form the transient.
[[nodiscard]] physics::RigModel chair_rig();

}  // namespace dts::sim
