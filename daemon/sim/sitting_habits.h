// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "physics/body/person.h"
#include "sim/seat_load.h"
#include "sim/seat_plate.h"

namespace dts::sim {

/// How one person sits and reaches; a `deviation` varies from trial to trial.
struct SittingHabits {
  SeatLoadParameters load;
  SeatContact contact;
  double rest_y_deviation_mm = 0.0;

  double arm_use = 1.0;         ///< Fraction of the arm's length that a person can stretch out; the trunk compensates for the rest.
  double flexion_factor = 1.0;  ///< Relative to the flexion that the geometry of a target needs.
  double flexion_offset_deg = 0.0;
  double flexion_midway_deg = 0.0;  ///< Additional flexion halfway between upright and 60 deg.
  double flexion_deviation_deg = 0.0;

  double phase_s = 0.75;              ///< Duration of one phase (forward or back) without the trunk.
  double phase_growth_per_deg = 0.0;  ///< Longer movements need more time.
  double phase_deviation = 0.0;       ///< As a fraction of the phase.
  double hold_s = 0.0;
  double hold_deviation = 0.0;
  double corrections = 0.0;  ///< Average number of sub-movements of a phase after the first one.
  double reaction_s = 0.25;  ///< From the cue to the first movement.

  double tremor_deg = 0.0;  ///< Of the trunk while it moves.
  double tremor_hz = 6.0;
  double sway_mm = 0.0;       ///< Of the position of the load, rms.
  double breathing = 0.0;     ///< As a fraction of the load.
  double restlessness = 0.0;  ///< Probability of a fidget or a shift of posture within 5 s.
};

/// Returns the thesis's model: the flexion that geometry predicts, in `phase_s`, without pause, noise or other variation.
[[nodiscard]] SittingHabits ideal_habits(const physics::Person& person, SeatLoadModel model, double phase_s);

/// Returns a random person for `seed`. `between_people`, 0 to 2, sets how much people differ: 0 not at all, 1 about as the angles of thesis
/// Table 6.3, more to test what was learnt from usual people. People after a stroke are slower, correct their movements, and use the trunk
/// where the arm alone would do. All figures are assumptions.
[[nodiscard]] SittingHabits natural_habits(const physics::Person& person, bool is_healthy, SeatLoadModel model, std::uint64_t seed,
                                           double between_people);

}  // namespace dts::sim
