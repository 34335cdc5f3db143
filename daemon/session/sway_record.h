// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/result.h"
#include "record/event.h"
#include "session/sway_results.h"

namespace dts::session {

/// Writes the event "sway" at the scan where the trial was decided: trial, attempt, condition, labels, first_segment, first_scan,
/// end_segment, end_scan; then either problem, or profile, rate_hz, samples, duration_s, flags (bits of sway_flag), flag_names, missing,
/// interpolated, is_valid, software and measures, {"MVELO":{"value":8.19,"unit":"mm/s"}, ...}.
[[nodiscard]] record::RecordedEvent to_record(const SwayTrialResult& result, const std::string& software);
/// Reads the event "sway". Fails with DataDamaged, naming the key, if a value is missing, of the wrong type or out of range.
[[nodiscard]] core::Result<SwayTrialResult> sway_of(const record::RecordedEvent& event);

}  // namespace dts::session
