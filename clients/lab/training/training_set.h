// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "classifier/subject_calibration.h"
#include "core/reach.h"

namespace dts::lab::training {

struct TrainingSubject {
  std::string name;
  bool is_simulated = false;
  double max_flexion_deg = 0.0;  ///< By geometry, because this is known for every person.
};

/// One reach of a healthy person with its label.
struct TrainingReach {
  std::size_t subject = 0;  ///< Index into TrainingSet::subjects.
  core::ReachFeatures features;
  std::uint16_t flags = 0;
  core::TrunkClass wanted = core::TrunkClass::None;  ///< 0 to 3.
  double flexion_deg = 0.0;  ///< Real person: by geometry, because the true angle is unknown. Simulated person: the true angle.
};

struct TrainingSet {
  std::vector<TrainingSubject> subjects;
  std::vector<TrainingReach> reaches;
};

/// Returns whether all its numbers are finite and no flag makes it unfit.
[[nodiscard]] bool is_usable(const TrainingReach& reach) noexcept;

/// Returns the set without the reaches of these subjects; the list of subjects does not change.
[[nodiscard]] TrainingSet without(const TrainingSet& set, const std::vector<std::size_t>& subjects);
[[nodiscard]] TrainingSet only(const TrainingSet& set, const std::vector<std::size_t>& subjects);

/// Returns the groups of subjects that are left out together: each real subject alone, simulated ones in eight groups.
[[nodiscard]] std::vector<std::vector<std::size_t>> folds_of(const TrainingSet& set);

/// Returns the subject's own scale from each three successive maximum reaches; empty if none are usable.
[[nodiscard]] std::vector<classifier::SubjectCalibration> calibrations_of(const TrainingSet& set, std::size_t subject);

/// Returns the SHA-256, hexadecimal, of all features and labels in a text form.
[[nodiscard]] std::string sha256_of(const TrainingSet& set);

}  // namespace dts::lab::training
