// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "classifier/trunk_model.h"
#include "core/result.h"
#include "lab/study/experiments.h"

namespace dts::lab::study {

/// Classifies each volunteer by a recommended model of all others.
[[nodiscard]] core::Result<RecommendedResult> classify_volunteers_left_out(const std::vector<const StudyGroup*>& groups, std::uint64_t seed,
                                                                           const Progress& progress);

/// Classifies all reaches by one model trained on other people, with rejection and intervals as in the daemon.
[[nodiscard]] RecommendedResult classify_by_model(const classifier::TrunkModel& model, const std::vector<const StudyGroup*>& groups);

/// An estimated angle and the true angle.
struct AngleError {
  std::size_t volunteer = 0;
  double estimated_deg = 0.0;
  double true_deg = 0.0;
};

/// Returns the fraction of true angles within a 90 % interval that is computed only from the errors of the other volunteers, one width per
/// class of the estimated angle. NaN with fewer than two volunteers.
[[nodiscard]] double coverage_left_out(const std::vector<AngleError>& errors, std::size_t volunteers);

}  // namespace dts::lab::study
