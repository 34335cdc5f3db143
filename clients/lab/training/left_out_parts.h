// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "classifier/trunk_model_form.h"
#include "lab/training/fits.h"
#include "lab/training/training_set.h"

namespace dts::lab::training {

/// A best guess by a model without this reach's subject, and the truth. Values fitted to such guesses (temperature, intervals) are
/// evaluated only on the guesses of other groups; otherwise they would always fit.
struct ClassifiedReach {
  const TrainingReach* reach = nullptr;
  core::TrunkMovement movement;
  std::size_t group = 0;                             ///< Number of the group of people that were left out together.
  double arm_alone = core::ReachFeatures::kUnknown;  ///< Probability that the trunk did not move.
};

/// Returns the forecasts for all reaches that moved the trunk, except those of the group `without`.
[[nodiscard]] std::vector<Forecast> forecasts_of(std::span<const ClassifiedReach> classified, std::optional<std::size_t> without = {});

/// Returns the half widths of 90 % intervals by the class of the estimated angle, from all reaches that moved the trunk, except those of
/// the group `without`.
[[nodiscard]] std::array<double, classifier::kClasses> residuals_of(std::span<const ClassifiedReach> classified,
                                                                    std::optional<std::size_t> without = {});

/// Returns the probability from which a reach counts as arm-only. At most one in a hundred reaches of class 1 have that probability,
/// because they must not become class 0. Without one group.
[[nodiscard]] double none_from_of(std::span<const ClassifiedReach> classified, std::optional<std::size_t> without = {});

/// Returns the guess, with class 0 and 1 separated by `none_from`: a model without left-out people does not have that value.
[[nodiscard]] core::TrunkClass guess_of(const ClassifiedReach& classified, double none_from);

[[nodiscard]] classifier::Network::Outputs tempered(classifier::Network::Outputs probability, double temperature);

/// Decides as TrunkModel::classify, but with `half_widths_deg` instead of the model's own. `movement` must be tempered.
[[nodiscard]] bool is_kept(const core::TrunkMovement& movement, const std::array<double, classifier::kClasses>& half_widths_deg,
                           double reject_below);

}  // namespace dts::lab::training
