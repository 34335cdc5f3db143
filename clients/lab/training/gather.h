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

/// Builds a training set from recorded trials of healthy people (others bend the trunk where they need not). The label is the requested
/// target; the flexion is what the target needs according to the person's measures. `names` selects subjects (empty: all). Fails with
/// InvalidArgument if a name is unknown or not of a healthy person, or if there is nothing to train on.
[[nodiscard]] core::Result<TrainingSet> gather(const reach::TrialSet& set, std::span<const std::optional<core::ReachEvent>> reaches,
                                               const std::vector<std::string>& names);

}  // namespace dts::lab::training
