// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "core/block.h"

namespace dts::pipeline {

/// Quality bits that make a value unfit to compute with. The others (no contact, uncalibrated, untared) qualify a result.
inline constexpr std::uint8_t kFaultBits =
    core::quality::kRail | core::quality::kStuck | core::quality::kOutOfRange | core::quality::kRotation;

/// Bits of `value` with the promise of Stage::process kept: a value that is not finite has a bit that says why.
/// Realtime-safe: yes.
[[nodiscard]] inline std::uint8_t explained(double value, std::uint8_t bits) noexcept {
  const bool needs_reason = !std::isfinite(value) && (bits & kFaultBits) == 0;
  return needs_reason ? static_cast<std::uint8_t>(bits | core::quality::kOutOfRange) : bits;
}

}  // namespace dts::pipeline
