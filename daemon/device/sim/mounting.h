// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "device/sim/counter_random.h"

namespace dts::device::sim {

/// How the sensors of one seed were mounted: gains and gaps must not repeat the numbers of the noise.
[[nodiscard]] inline CounterRandom mounting_random(std::uint64_t seed) noexcept { return CounterRandom(seed ^ 0x6d6f756e74ULL); }

/// Evenly in -1 .. 1.
[[nodiscard]] inline double either_side(const CounterRandom& random, std::uint64_t n) noexcept { return 2.0 * random.uniform(n) - 1.0; }

}  // namespace dts::device::sim
