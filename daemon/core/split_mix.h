// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dts::core {

/// splitmix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators"): number n of a state is
/// `split_mix(state + n * kGoldenGamma)`. Thread: any. Realtime-safe: yes.
inline constexpr std::uint64_t kGoldenGamma = 0x9e3779b97f4a7c15U;

[[nodiscard]] constexpr std::uint64_t split_mix(std::uint64_t z) noexcept {
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31U);
}

}  // namespace dts::core
