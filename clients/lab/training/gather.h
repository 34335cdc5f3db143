// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "lab/reach/trial_set.h"
#include "lab/training/training_set.h"

namespace dts::lab::training {

/// What there is to learn from recorded trials: of healthy people (others bend the trunk where they need not), labelled by the target that
/// was asked for, with the flexion that it takes by the person's measures. `names` (empty: all) chooses subjects. Fails with
/// InvalidArgument when a name is not there or not of a healthy person, or when there is nothing to learn from.
[[nodiscard]] core::Result<TrainingSet> gather(const reach::TrialSet& set, std::span<const std::optional<core::ReachEvent>> reaches,
                                               const std::vector<std::string>& names);

}  // namespace dts::lab::training
