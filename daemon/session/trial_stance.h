// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/rate.h"
#include "core/units.h"
#include "pipeline/subject_stance.h"
#include "session/trial_run.h"

namespace dts::session {

/// Returns the stance width in mm that a session states in the field "stance_width_mm"; 0: unknown.
[[nodiscard]] double stance_width_mm(const std::vector<std::pair<std::string, std::string>>& fields);

/// Announces to the stage `cop` on how many feet the subject stands in a trial, if `event` is its "Go" at `scan`: on one foot if the
/// trial's label feet is "one", else on two. Valid from 0.5 s after "Go" until another trial asks for something else: the delay gives the
/// stage time to receive it, so that a replay, which calls this function with the recorded event, changes at the same scan.
void announce_feet(pipeline::SubjectStances& stances, const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan,
                   const core::Rate& raw_rate);

}  // namespace dts::session
