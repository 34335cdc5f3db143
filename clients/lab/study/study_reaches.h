// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/reach.h"
#include "core/result.h"
#include "lab/study/volunteers.h"
#include "lab/training/training_set.h"

namespace dts::lab::study {

/// A simulated trial of a volunteer, and its reach as the daemon's own stages found it.
struct StudyReach {
  std::size_t volunteer = 0;  ///< Index into StudyGroup::volunteers.
  std::string condition;      ///< "120"
  core::TrunkClass wanted = core::TrunkClass::None;
  double flexion_deg = 0.0;               ///< True flexion of the simulated trunk.
  std::optional<core::ReachEvent> reach;  ///< Empty: no reach was found.
};

struct StudyGroup {
  std::vector<Volunteer> volunteers;
  std::vector<StudyReach> reaches;
};

/// Returns labels and true angles for training, without reaches that were not found.
[[nodiscard]] training::TrainingSet training_set(const std::vector<const StudyGroup*>& groups);

using Progress = std::function<void(double)>;

enum class Targets : std::uint8_t {
  BeyondReach = 1,  ///< 120 %, 150 % and the maximum, which the thesis's networks distinguish.
  All,              ///< These, and 80 and 100 %.
};

/// Simulates natural behaviour of healthy people: 15 reaches to each target. `seed` selects the people: another seed gives other people
/// with the same body measures. Synthetic. `volunteers` become one group.
[[nodiscard]] core::Result<StudyGroup> natural_reaches(std::span<const Volunteer> volunteers, Targets targets, std::uint64_t seed,
                                                       const Progress& progress);

/// Simulates reaches after a stroke: 15 reaches to a target at which the simulated trunk bends by the angle that the thesis measured at the
/// critical boundary.
[[nodiscard]] core::Result<StudyGroup> boundary_reaches(std::span<const Volunteer> volunteers, std::uint64_t seed,
                                                        const Progress& progress);

/// Simulates reaches of the body model to 120 %, 150 % and the maximum without noise or habits: `repetitions` of each at every pace, the
/// duration of one phase in s (thesis 5.4.2: 0.75).
[[nodiscard]] core::Result<StudyGroup> ideal_reaches(std::span<const Volunteer> volunteers, std::span<const double> paces_s,
                                                     int repetitions);

}  // namespace dts::lab::study
