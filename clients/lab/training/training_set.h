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
  double max_flexion_deg = 0.0;  ///< By geometry, as it is known of anybody.
};

/// One reach of a healthy person with what it should be told to be.
struct TrainingReach {
  std::size_t subject = 0;  ///< Index into TrainingSet::subjects.
  core::ReachFeatures features;
  std::uint16_t flags = 0;
  core::TrunkClass wanted = core::TrunkClass::None;  ///< 0 to 3.
  double flexion_deg = 0.0;  ///< Of a real person by geometry, since the true angle is not known; of a simulated one the true one.
};

struct TrainingSet {
  std::vector<TrainingSubject> subjects;
  std::vector<TrainingReach> reaches;
};

/// Its numbers are finite and no flag makes it unfit.
[[nodiscard]] bool is_usable(const TrainingReach& reach) noexcept;

/// Without the reaches of these subjects; the list of subjects stays.
[[nodiscard]] TrainingSet without(const TrainingSet& set, const std::vector<std::size_t>& subjects);
[[nodiscard]] TrainingSet only(const TrainingSet& set, const std::vector<std::size_t>& subjects);

/// Subjects that are left out together: each real one by itself, simulated ones in eight groups.
[[nodiscard]] std::vector<std::vector<std::size_t>> folds_of(const TrainingSet& set);

/// The subject's own scale out of each three successive maximum reaches; empty when there are none that serve.
[[nodiscard]] std::vector<classifier::SubjectCalibration> calibrations_of(const TrainingSet& set, std::size_t subject);

/// SHA-256, hexadecimal, of all features and labels in a text form.
[[nodiscard]] std::string sha256_of(const TrainingSet& set);

}  // namespace dts::lab::training
