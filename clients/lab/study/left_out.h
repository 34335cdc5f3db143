// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "classifier/trunk_model.h"
#include "core/result.h"
#include "lab/study/experiments.h"

namespace dts::lab::study {

/// Each volunteer by a recommended model of all others.
[[nodiscard]] core::Result<RecommendedResult> judge_volunteers_left_out(const std::vector<const StudyGroup*>& groups, std::uint64_t seed,
                                                                        const Progress& progress);

/// All reaches by one model that was taught by others. With rejection and intervals as the daemon uses it.
[[nodiscard]] RecommendedResult judge_by_model(const classifier::TrunkModel& model, const std::vector<const StudyGroup*>& groups);

/// An angle that was estimated beside the true one.
struct AngleError {
  std::size_t volunteer = 0;
  double estimated_deg = 0.0;
  double true_deg = 0.0;
};

/// Part of the true angles within a 90 % interval that only the errors of the other volunteers made, one width per class of the estimated
/// angle. NaN without two volunteers.
[[nodiscard]] double coverage_left_out(const std::vector<AngleError>& errors, std::size_t volunteers);

}  // namespace dts::lab::study
