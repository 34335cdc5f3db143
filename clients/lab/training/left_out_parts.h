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

/// A best guess of a model that never saw the reach's subject, beside the truth. What is fitted to such guesses (temperature, intervals)
/// is judged by the guesses of other groups only, else it would always hold.
struct JudgedReach {
  const TrainingReach* reach = nullptr;
  core::TrunkMovement movement;
  std::size_t group = 0;                             ///< People who were left out together.
  double arm_alone = core::ReachFeatures::kUnknown;  ///< Probability that the trunk did not move.
};

/// Of reaches that moved the trunk, without one group.
[[nodiscard]] std::vector<Forecast> forecasts_of(std::span<const JudgedReach> judged, std::optional<std::size_t> without = {});

/// Half widths of 90 % intervals by the class of the angle that was estimated, from reaches that moved the trunk, without one group.
[[nodiscard]] std::array<double, classifier::kClasses> residuals_of(std::span<const JudgedReach> judged,
                                                                    std::optional<std::size_t> without = {});

/// From which probability on it is the arm alone: one that at most two in a hundred reaches of class 1 have, without one group. These must
/// not get lost to class 0.
[[nodiscard]] double none_from_of(std::span<const JudgedReach> judged, std::optional<std::size_t> without = {});

/// The guess with class 0 and 1 told apart by `none_from`: a model that was fitted without people left out does not know it.
[[nodiscard]] core::TrunkClass guess_of(const JudgedReach& judged, double none_from);

[[nodiscard]] classifier::Network::Outputs tempered(classifier::Network::Outputs probability, double temperature);

/// As TrunkModel::classify decides, with these half widths in place of the model's: `movement` has been tempered.
[[nodiscard]] bool is_kept(const core::TrunkMovement& movement, const std::array<double, classifier::kClasses>& half_widths_deg,
                           double reject_below);

}  // namespace dts::lab::training
