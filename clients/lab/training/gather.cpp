// SPDX-License-Identifier: Apache-2.0
#include "lab/training/gather.h"

#include <algorithm>
#include <cmath>

namespace dts::lab::training {
namespace {

using ReachSpan = std::span<const std::optional<core::ReachEvent>>;

core::Status check_names(const reach::TrialSet& set, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const auto found =
        std::find_if(set.subjects.begin(), set.subjects.end(), [&](const reach::Subject& subject) { return subject.name == name; });
    if (found == set.subjects.end())
      return core::fail(core::ErrorCode::InvalidArgument, "no subject " + name, "give a name from subjects.csv");
    if (!found->is_healthy) {
      return core::fail(core::ErrorCode::InvalidArgument,
                        "subject " + name + " is not healthy: the target does not predict the trunk movement",
                        "train only on healthy people");
    }
  }
  return {};
}

std::optional<TrainingReach> reach_of(const reach::Trial& trial, const reach::Subject& subject, const core::ReachEvent& event) {
  const auto wanted = reach::class_of_condition(trial.condition);
  const auto target_cm = reach::target_cm(subject.person, trial.condition);
  if (!wanted || !target_cm) return std::nullopt;
  const double flexion_deg = physics::trunk_flexion_deg(subject.person, *target_cm);
  if (!std::isfinite(flexion_deg)) return std::nullopt;
  return TrainingReach{
      .subject = trial.subject, .features = event.features, .flags = event.flags, .wanted = *wanted, .flexion_deg = flexion_deg};
}

}  // namespace

core::Result<TrainingSet> gather(const reach::TrialSet& set, ReachSpan reaches, const std::vector<std::string>& names) {
  DTS_TRY(check_names(set, names));
  TrainingSet result;
  for (const reach::Subject& subject : set.subjects) {
    result.subjects.push_back(
        {.name = subject.name, .max_flexion_deg = physics::trunk_flexion_deg(subject.person, subject.person.max_reach_cm)});
  }
  for (std::size_t k = 0; k < set.trials.size() && k < reaches.size(); ++k) {
    const reach::Trial& trial = set.trials[k];
    const reach::Subject& subject = set.subjects[trial.subject];
    const bool is_wanted = names.empty() || std::find(names.begin(), names.end(), subject.name) != names.end();
    if (!is_wanted || !subject.is_healthy || !reaches[k]) continue;
    if (auto reach = reach_of(trial, subject, *reaches[k])) result.reaches.push_back(std::move(*reach));
  }
  if (!result.reaches.empty()) return result;
  return core::fail(core::ErrorCode::InvalidArgument, "no reach of a healthy person to a known target was found",
                    "add trials of healthy subjects at 80, 100, 120, 150 and max");
}

}  // namespace dts::lab::training
