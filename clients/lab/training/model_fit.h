// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "classifier/trunk_model_form.h"
#include "core/result.h"
#include "lab/training/training_set.h"

namespace dts::lab::training {

struct ModelOptions {
  classifier::ModelKind kind = classifier::ModelKind::Recommended;
  std::size_t networks = 11;  ///< Per ensemble; raw5 always has one.
  std::uint64_t seed = 1;
};

/// Fits everything that depends only on the reaches: networks, polynomials, the arm-only rule. Temperatures are 1, residuals wide and
/// left-out figures unknown, because these need left-out people.
[[nodiscard]] core::Result<classifier::TrunkModelForm> fit_model(const TrainingSet& set, const ModelOptions& options);

}  // namespace dts::lab::training
