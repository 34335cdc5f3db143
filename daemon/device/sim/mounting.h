// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/counter_random.h"

namespace dts::device::sim {

/// Returns the random numbers for gains and gaps of the sensors; they must differ from the numbers of the noise with the same seed.
[[nodiscard]] inline dts::sim::CounterRandom mounting_random(std::uint64_t seed) noexcept {
  return dts::sim::CounterRandom(seed ^ 0x6d6f756e74ULL);
}

}  // namespace dts::device::sim
