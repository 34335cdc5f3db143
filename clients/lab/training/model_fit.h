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
  std::size_t networks = 11;  ///< Of each ensemble; raw5 always has one.
  std::uint64_t seed = 1;
};

/// Everything that is fitted to the reaches themselves: networks, polynomials, the rule for the arm alone. Temperatures are 1, residuals
/// wide and left-out figures unknown: those take people left out.
[[nodiscard]] core::Result<classifier::TrunkModelForm> fit_model(const TrainingSet& set, const ModelOptions& options);

}  // namespace dts::lab::training
