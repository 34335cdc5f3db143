// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/result.h"
#include "lab/reach/trial_set.h"
#include "physics/body/seat_load.h"

namespace dts::lab::study {

/// Which trials simulated people perform.
struct TrialPlan {
  std::vector<std::string> conditions{"120", "150", "max"};
  int trials_per_condition = 15;
  std::vector<double> paces_s{};  ///< Of one phase, one trial after the other; empty: 0.75 s when ideal, else as it comes naturally.
  bool is_ideal = false;          ///< The model's reach without noise, pause or habits (thesis 5.4).
  double between_people = 1.0;    ///< 0..1: how much people differ, see physics::natural_habits.
  physics::SeatLoadModel load_model = physics::SeatLoadModel::Cop;
  double rate_hz = 100.0;
  std::uint64_t seed = 1;
  bool has_volts = true;  ///< false: only what the trunk will do, which takes a thousandth of the time.
};

struct SimulatedTrials {
  reach::TrialSet set;
  std::vector<double> trunk_deg;  ///< True flexion at the target, per trial.
};

/// Trials like those of the development data: from 1 to 2 s of rest before a reach to rest after it, as volts of the four sensors of the
/// chair's transient. Subject by subject, condition by condition; a target beyond a subject's maximum reach is left out, as in thesis
/// 6.3.3. The same plan gives the same trials. Fails with InvalidArgument when the plan makes no sense.
[[nodiscard]] core::Result<SimulatedTrials> simulate_trials(const std::vector<reach::Subject>& subjects, const TrialPlan& plan,
                                                            const std::function<void(double)>& progress);

}  // namespace dts::lab::study
