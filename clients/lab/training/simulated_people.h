// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/result.h"
#include "lab/reach/trial_set.h"
#include "lab/training/training_set.h"

namespace dts::lab::training {

/// Invents healthy people within the body measures of adults: names "sim1", "sim2", ... The same seed gives the same people.
[[nodiscard]] std::vector<reach::Subject> invent_people(std::size_t count, std::uint64_t seed);

/// Simulates their reaches to all five targets, `trials` per target, as the daemon's stages find them, with the true trunk movement.
/// Synthetic.
[[nodiscard]] core::Result<TrainingSet> simulated_people(std::size_t count, int trials, std::uint64_t seed,
                                                         const std::function<void(double)>& progress);

/// Returns both sets, with the subjects of `b` after those of `a`.
[[nodiscard]] TrainingSet joined(TrainingSet a, const TrainingSet& b);

}  // namespace dts::lab::training
