// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/rate.h"
#include "core/reach.h"
#include "files/toml_reader.h"
#include "physics/body/person.h"
#include "physics/rig_model.h"

namespace dts::lab::reach {

struct Subject {
  std::string name;  ///< "A"
  bool is_healthy = true;
  physics::Person person;
};

/// One recorded reach: the volts of four sensors.
struct Trial {
  std::size_t subject = 0;  ///< Index into TrialSet::subjects.
  std::uint32_t number = 0;
  std::string condition;  ///< Requested target: "80", "100", "120", "150", "max"; empty: unknown.
  core::Rate rate;
  std::vector<std::array<double, 4>> volts;
};

/// A folder with the structure of the development data: subjects.csv, trials.csv (only subject, trial, condition, rate_hz and the name of
/// the file with the trial are read), sensors.csv, calibration.csv and one file of volts per subject.
struct TrialSet {
  physics::RigModel rig;  ///< Four sensors with their curves; unloaded gaps are from the tare voltages.
  std::vector<Subject> subjects;
  std::vector<Trial> trials;
};

/// Adds every error to `problems` with file:line:column; the returned set is complete only if there were none.
[[nodiscard]] TrialSet read_trial_set(const std::string& folder, files::Problems& problems);

/// Returns the class of a healthy person's reach from the requested target: 0 for 80 and 100, 1 for 120, 2 for 150, 3 for max; nothing for
/// other targets.
[[nodiscard]] std::optional<core::TrunkClass> class_of_condition(const std::string& condition);

/// Returns the distance of a target from the acromion, cm: a fraction of the arm's length, or the maximum reach. Returns nothing if the
/// condition is not a target.
[[nodiscard]] std::optional<double> target_cm(const physics::Person& person, const std::string& condition);

/// Finds the reach of each trial of `set` with the daemon's own stages (guard, linearise, transient, reach); nothing for a trial without a
/// reach. Same order and length as `set.trials`.
[[nodiscard]] std::vector<std::optional<core::ReachEvent>> find_reaches(const TrialSet& set, const std::function<void(double)>& progress);

}  // namespace dts::lab::reach
