// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/body/counter_random.h"

namespace dts::device::sim {

using physics::CounterRandom;

}  // namespace dts::device::sim
