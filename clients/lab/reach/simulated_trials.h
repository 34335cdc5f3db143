// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "lab/reach/trial_set.h"
#include "sim/seat_load.h"

namespace dts::lab::reach {

/// The trials that simulated people perform.
struct TrialPlan {
  std::vector<std::string> conditions{"120", "150", "max"};
  int trials_per_condition = 15;
  std::vector<double> paces_s{};  ///< Duration of one phase, used in turn for successive trials; empty: 0.75 s if ideal, else natural.
  bool is_ideal = false;          ///< The model's reach without noise, pause or habits (thesis 5.4).
  double between_people = 1.0;    ///< 0..2: how much people differ, see sim::natural_habits.
  sim::SeatLoadModel load_model = sim::SeatLoadModel::Cop;
  double rate_hz = 100.0;
  double noise_v = 3e-3;  ///< Standard deviation of the noise of each sensor, per scan; not if ideal.
  /// How far the trunk turns from its rest at the back rest, deg: the same in all trials, whatever the targets need. 0: only the arm moves.
  std::optional<double> trunk_turn_deg{};
  std::uint64_t seed = 1;
  bool has_volts = true;  ///< false: only the trunk angles, which is a thousand times faster.
};

struct SimulatedTrials {
  reach::TrialSet set;
  std::vector<double> trunk_deg;  ///< True flexion at the target, per trial.
};

/// Simulates trials like those of the development data: from 1 to 2 s of rest before a reach to rest after it, as volts of the four sensors
/// of the chair's transient. Ordered by subject, then by condition; skips a target beyond a subject's maximum reach, as thesis 6.3.3. The
/// same plan gives the same trials. Fails with InvalidArgument if the plan is invalid.
[[nodiscard]] core::Result<SimulatedTrials> simulate_trials(const std::vector<reach::Subject>& subjects, const TrialPlan& plan,
                                                            const std::function<void(double)>& progress);

}  // namespace dts::lab::reach
