// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "report/canvas.h"
#include "report/chair_data.h"

namespace dts::report {

/// Draws the seat's deflection against the time after the cue: as recorded in grey, as mean over 50 ms in colour; with P1, P2, P3, the
/// reach initiation from P1 to P2, d1 and d2.
void draw_transient(Canvas& canvas, double width, double height, const ChairTrial& trial);

/// Draws the trunk angle with its 90 % interval on a scale of 0 to 90 degrees with the trunk classes; marks the expected class.
void draw_trunk_scale(Canvas& canvas, double width, double height, const ChairTrial& trial);

/// Draws the trunk angle of every valid trial, one column per target, with its mean and standard deviation, over the trunk classes.
void draw_angles(Canvas& canvas, double width, double height, const ChairData& chair);

/// Draws the valid reaches of each target over each other, aligned at P1; one scale for all targets.
void draw_reaches(Canvas& canvas, double width, double height, const ChairData& chair);

/// Returns the valid trials with a reach to one target, in the order of the recording.
[[nodiscard]] std::vector<const ChairTrial*> trials_to(const ChairData& chair, const session::TargetSummary& target);
/// Returns "100 % of arm length", or "no target".
[[nodiscard]] std::string target_text(const ChairData& chair, const std::string& condition);

inline constexpr std::size_t kMostTargetsDrawn = 8;

}  // namespace dts::report
