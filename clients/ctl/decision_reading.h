// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "dts/v1/stream.pb.h"

namespace dts::ctl {

/// Returns "like 60plus, p 0.83", "no decision: RANGE_AP is outside of the training" or why else there is no decision.
[[nodiscard]] std::string decision_text(const dts::v1::SteadinessDecision& decision);
/// Returns what must stand beside every decision: the people and the condition of the training, how well it works, and what works as well.
[[nodiscard]] std::string decision_limits(const dts::v1::SteadinessDecision& decision);

}  // namespace dts::ctl
