// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "dts/v1/sessions.pb.h"
#include "dts/v1/stream.pb.h"

namespace dts::report {

/// The sentence that limits every decision. The dashboard has the same (clients/web/src/strings); its test compares them.
inline constexpr std::string_view kDecisionLimit = "No statement about health or risk of falling.";

/// Returns the decision about a trial that counts; nullptr without one, and for a trial that was redone, rejected or aborted.
[[nodiscard]] const v1::SteadinessDecision* kept_decision(const v1::TrialRecord& trial) noexcept;
/// Returns "like 60plus, p 0.83", "no decision: RANGE_AP is outside of the training" or why else there is no decision.
[[nodiscard]] std::string decision_text(const v1::SteadinessDecision& decision);
/// Returns what must stand beside every decision, one sentence each: the people and the condition of the training, how well it works, what
/// works as well, and last `kDecisionLimit`.
[[nodiscard]] std::vector<std::string> decision_limits(const v1::SteadinessDecision& decision);

}  // namespace dts::report
