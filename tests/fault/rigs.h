// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/clock.h"
#include "pipeline/rig_config.h"

namespace dts::fault {

inline constexpr const char* kDevice = "sim:floor?seed=7";

/// The shipped floor with 16 sensors (config/rigs/floor16-sim.toml) at 1500 Hz: as text, and as the daemon reads it.
[[nodiscard]] std::string floor16_text();
[[nodiscard]] pipeline::RigConfig floor16_rig();
/// The shipped floor with 4 sensors at 100 Hz.
[[nodiscard]] pipeline::RigConfig floor4_rig();

/// Of a PatientClock: two seconds of recording take some 0.2 s, and lose nothing on a busy machine.
inline constexpr std::int64_t kClockStepNs = 5 * core::kNanosecondsPerMillisecond;

}  // namespace dts::fault
