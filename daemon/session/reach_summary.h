// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "session/reach_results.h"

namespace dts::session {

/// Figures of all trials of a session. Each is there only when something gives it a value; `details` is one JSON object.
///
/// | name | unit | what |
/// |---|---|---|
/// | trials | 1 | trials that count |
/// | reaches_detected_share | 1 | of the trials without a gap |
/// | rejected_share | 1 | of the classified reaches: no class was given |
/// | class_agreement_share | 1 | class is what the target takes, of the reaches with a class; arm alone and no reach found agree, too |
/// | trunk_at_critical_boundary_deg | deg | mean trunk flexion at P3 in reaches to the critical boundary, see below |
/// | trunk_sd_deg, d2_sd_mm | deg, mm | consistency: standard deviation within a target, pooled over the targets |
/// | sparc_mean | 1 | smoothness: spectral arc length of P1 to P3 (Balasubramanian et al. 2012), nearer 0 is smoother |
/// | targets | 1 | how many targets; in `details` all of the above per target, with the count of each class |
///
/// The critical boundary is how far the finger tips come without the trunk: 1.15 arm lengths (thesis 5.3). Trials to the one target nearest
/// to it count, whatever is nearest within it for a person who reaches less far (thesis 6.4.2.1: S1), but none beyond 1.2 arm lengths,
/// where the target itself makes the trunk bend. A rejected reach gives an angle only when no more than its class is unsure.
[[nodiscard]] std::vector<SessionFigure> summarize(std::span<const ReachTrialResult> results, const std::optional<physics::Person>& person);

}  // namespace dts::session
