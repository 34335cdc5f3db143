// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/body/person.h"

namespace dts::physics::test {

/// Volunteer A of thesis Table 5.1.
inline constexpr Person kVolunteerA{.weight_kg = 68.0, .height_cm = 175.0, .arm_length_cm = 67.0, .max_reach_cm = 124.0};

}  // namespace dts::physics::test
