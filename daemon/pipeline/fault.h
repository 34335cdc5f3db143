// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "core/block.h"

namespace dts::pipeline {

/// Quality bits of values that must not be used in computations. The other bits (no contact, uncalibrated, untared) only qualify a result.
inline constexpr std::uint8_t kFaultBits =
    core::quality::kRail | core::quality::kStuck | core::quality::kOutOfRange | core::quality::kRotation;

/// Returns the bits of `value`, with a reason added if it is not finite and has none: Stage::process promises such a bit.
/// Realtime-safe: yes.
[[nodiscard]] inline std::uint8_t explained(double value, std::uint8_t bits) noexcept {
  const bool needs_reason = !std::isfinite(value) && (bits & kFaultBits) == 0;
  return needs_reason ? static_cast<std::uint8_t>(bits | core::quality::kOutOfRange) : bits;
}

}  // namespace dts::pipeline
