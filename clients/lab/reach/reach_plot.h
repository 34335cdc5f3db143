// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/reach.h"
#include "core/result.h"
#include "lab/reach/trial_set.h"

namespace dts::lab::reach {

/// Draws the transient of the first trial of each condition with its P1, P2, P3 (thesis Fig. 5.6). `reaches` must be those of `set.trials`.
[[nodiscard]] core::Status plot_reaches(const TrialSet& set, const std::vector<std::optional<core::ReachEvent>>& reaches,
                                        const std::string& file);

}  // namespace dts::lab::reach
