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
  std::string condition;  ///< Target asked for: "80", "100", "120", "150", "max"; empty: not known.
  core::Rate rate;
  std::vector<std::array<double, 4>> volts;
};

/// A folder laid out as the development data: subjects.csv, trials.csv (of which only subject, trial, condition and rate_hz are read, and
/// the file that holds the trial), sensors.csv, calibration.csv and one file of volts per subject.
struct TrialSet {
  physics::RigModel rig;  ///< Four sensors with their curves; unloaded gaps are those of the tare voltages.
  std::vector<Subject> subjects;
  std::vector<Trial> trials;
};

/// Everything wrong is added to `problems` with file:line:column; what is returned is complete only when nothing was.
[[nodiscard]] TrialSet read_trial_set(const std::string& folder, files::Problems& problems);

/// Class of a healthy person's reach by the target asked for: 0 for 80 and 100, 1 for 120, 2 for 150, 3 for max; nothing for others.
[[nodiscard]] std::optional<core::TrunkClass> class_of_condition(const std::string& condition);

/// Distance of a target from the acromion, cm: a part of the arm's length, or the maximum reach. Nothing when the condition is no target.
[[nodiscard]] std::optional<double> target_cm(const physics::Person& person, const std::string& condition);

/// The reach of each trial of `set`, found by the daemon's own stages (guard, linearise, transient, reach), or nothing where there was
/// none. Same order and length as `set.trials`.
[[nodiscard]] std::vector<std::optional<core::ReachEvent>> find_reaches(const TrialSet& set, const std::function<void(double)>& progress);

}  // namespace dts::lab::reach
