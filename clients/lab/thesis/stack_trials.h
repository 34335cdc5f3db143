// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/result.h"
#include "lab/thesis/thesis.h"

namespace dts::lab::thesis {

inline constexpr std::size_t kStackVolunteers = 5;

/// The last 20 s of a trial on a simulated floor platform that lies on a simulated force plate, mm by scan.
struct StackTrial {
  struct Axis {
    std::vector<double> floor_mm;  ///< From the floor platform's stages.
    std::vector<double> plate_mm;  ///< From the force plate's stages, on top of the platform.
  };
  Axis ml;
  Axis ap;
};

/// Root mean squares: of floor platform minus force plate, and of how far the force plate's path moves in 50 ms, which is the difference
/// that two equal devices with such an error between their clocks would show.
struct AxisComparison {
  double raw_mm = 0.0;
  double mean_removed_mm = 0.0;
  double moved_in_50_ms_mm = 0.0;
};
[[nodiscard]] AxisComparison compare(const StackTrial::Axis& axis);

/// Trials of V1 to V5.
struct StackTrials {
  std::array<StackTrial, kStackVolunteers> two_feet;
  std::array<StackTrial, kStackVolunteers> one_foot;
};

/// Simulates ten trials of 25 s at 100 Hz, of which the first 5 s are discarded, through the stages of both rigs (thesis 4.6).
[[nodiscard]] core::Result<StackTrials> simulate_stack_trials(const TableProgress& progress);

/// Returns the simulated volunteers in words: "V1 55 kg".
[[nodiscard]] std::string stack_volunteers_text();

/// Returns the script for gnuplot that draws figures 4.11 to 4.13.
[[nodiscard]] std::string stack_figures(const StackTrials& trials);

}  // namespace dts::lab::thesis
