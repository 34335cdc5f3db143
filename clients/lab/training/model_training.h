// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "classifier/trunk_model.h"
#include "core/result.h"
#include "lab/training/fits.h"
#include "lab/training/model_fit.h"
#include "lab/training/training_set.h"

namespace dts::lab::training {

/// A reach classified by a model without its subject.
struct LeftOutReach {
  std::size_t reach = 0;  ///< Index into TrainingSet::reaches.
  core::TrunkMovement general;
  core::TrunkMovement own;  ///< With the scale of the subject's first three maximum reaches; equal to `general` if these are not usable.
  bool has_own = false;
  double arm_alone = core::ReachFeatures::kUnknown;  ///< Probability that the trunk did not move.
};

/// Classifies each person by a model of all others (reach-model section 6), which gives realistic figures. Fails if the fold of one subject
/// cannot be trained.
[[nodiscard]] core::Result<std::vector<LeftOutReach>> classify_left_out(const TrainingSet& set, const ModelOptions& options,
                                                                        const std::function<void(double)>& progress);

/// Fits a model, then sets temperatures, intervals and figures from left-out people. Figures are from recorded people if there are at least
/// two; those of the angle are from simulated people if there are any. Fails if the networks do not learn their task, because a model that
/// guesses must not be used.
[[nodiscard]] core::Result<classifier::TrunkModel> train_model(const TrainingSet& set, const ModelOptions& options,
                                                               const std::function<void(double)>& progress);

}  // namespace dts::lab::training
