// SPDX-License-Identifier: Apache-2.0
#include "lab/training/training_set.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "classifier/trunk_model.h"
#include "files/toml_text.h"
#include "record/sha256.h"

namespace dts::lab::training {
namespace {

constexpr std::size_t kSimulatedGroups = 8;

bool is_among(const std::vector<std::size_t>& subjects, std::size_t subject) {
  return std::find(subjects.begin(), subjects.end(), subject) != subjects.end();
}

TrainingSet filtered(const TrainingSet& set, const std::vector<std::size_t>& subjects, bool is_wanted) {
  TrainingSet result{.subjects = set.subjects, .reaches = {}};
  std::copy_if(set.reaches.begin(), set.reaches.end(), std::back_inserter(result.reaches),
               [&](const TrainingReach& reach) { return is_among(subjects, reach.subject) == is_wanted; });
  return result;
}

std::string number_text(double value) { return std::isfinite(value) ? files::toml_number(value) : ""; }

}  // namespace

bool is_usable(const TrainingReach& reach) noexcept {
  return (reach.flags & classifier::kUnfitFlags) == 0 && std::isfinite(reach.features.d1_mm()) && std::isfinite(reach.features.d2_mm()) &&
         reach.features.p1_mm > 0.0;
}

TrainingSet without(const TrainingSet& set, const std::vector<std::size_t>& subjects) { return filtered(set, subjects, false); }

TrainingSet only(const TrainingSet& set, const std::vector<std::size_t>& subjects) { return filtered(set, subjects, true); }

std::vector<std::vector<std::size_t>> folds_of(const TrainingSet& set) {
  std::vector<std::vector<std::size_t>> folds;
  std::vector<std::vector<std::size_t>> simulated(kSimulatedGroups);
  std::size_t count = 0;
  for (std::size_t subject = 0; subject < set.subjects.size(); ++subject) {
    if (set.subjects[subject].is_simulated) {
      simulated[count++ % kSimulatedGroups].push_back(subject);
    } else {
      folds.push_back({subject});
    }
  }
  std::copy_if(simulated.begin(), simulated.end(), std::back_inserter(folds), [](const auto& group) { return !group.empty(); });
  return folds;
}

std::vector<classifier::SubjectCalibration> calibrations_of(const TrainingSet& set, std::size_t subject) {
  std::vector<core::ReachFeatures> reaches;
  for (const TrainingReach& reach : set.reaches) {
    const bool is_fit = reach.subject == subject && reach.wanted == core::TrunkClass::Maximum && is_usable(reach) &&
                        (reach.flags & core::reach_flag::kMinor) == 0;
    if (is_fit) reaches.push_back(reach.features);
  }
  std::vector<classifier::SubjectCalibration> calibrations;
  for (std::size_t first = 0; first + classifier::kCalibrationReaches <= reaches.size(); first += classifier::kCalibrationReaches) {
    const auto calibration = classifier::calibrate_subject(std::span(reaches).subspan(first, classifier::kCalibrationReaches),
                                                           set.subjects[subject].max_flexion_deg);
    if (calibration) calibrations.push_back(*calibration);
  }
  return calibrations;
}

std::string sha256_of(const TrainingSet& set) {
  std::string text;
  for (const TrainingReach& reach : set.reaches) {
    const core::ReachFeatures& features = reach.features;
    text += set.subjects[reach.subject].name + "," + std::to_string(static_cast<int>(reach.wanted)) + "," + std::to_string(reach.flags);
    for (const double value : {reach.flexion_deg, features.p1_mm, features.p2_mm, features.p3_mm, features.hold_mm, features.rise_s,
                               features.rest_ratio, features.ratio_change}) {
      text += "," + number_text(value);
    }
    text += "\n";
  }
  return record::sha256_of(text);
}

}  // namespace dts::lab::training
