// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "physics/body/person.h"
#include "physics/body/seat_load.h"
#include "physics/body/seat_plate.h"

namespace dts::physics {

/// How one person sits and reaches; what differs from trial to trial is a deviation.
struct SittingHabits {
  SeatLoadParameters load;
  SeatContact contact;
  double rest_y_deviation_mm = 0.0;

  double arm_use = 1.0;         ///< Part of the arm's length that a person can stretch out; the trunk makes up for the rest.
  double flexion_factor = 1.0;  ///< Of the flexion that a target takes by geometry.
  double flexion_offset_deg = 0.0;
  double flexion_midway_deg = 0.0;  ///< Further flexion halfway between upright and 60 deg.
  double flexion_deviation_deg = 0.0;

  double phase_s = 0.75;              ///< There, or back, without the trunk.
  double phase_growth_per_deg = 0.0;  ///< Longer ways take longer.
  double phase_deviation = 0.0;       ///< Of the phase.
  double hold_s = 0.0;
  double hold_deviation = 0.0;
  double corrections = 0.0;  ///< Sub-movements of a phase beyond the first one, on average.
  double reaction_s = 0.25;  ///< From the cue to the first movement.

  double tremor_deg = 0.0;  ///< Of the trunk while it moves.
  double tremor_hz = 6.0;
  double sway_mm = 0.0;       ///< Of the load's place, rms.
  double breathing = 0.0;     ///< Part of the load.
  double restlessness = 0.0;  ///< Chance of a fidget or a shift of posture within 5 s.
};

/// Moves as the thesis's model: the angle that geometry gives, in `phase_s`, without pause, noise or anything else.
[[nodiscard]] SittingHabits ideal_habits(const Person& person, SeatLoadModel model, double phase_s);

/// A person drawn by `seed`. `between_people` is how much people differ: 0 not at all, 1 about as the angles of thesis Table 6.3. Those
/// after a stroke are slower, correct themselves, and use the trunk where the arm would do. All figures are assumptions.
[[nodiscard]] SittingHabits natural_habits(const Person& person, bool is_healthy, SeatLoadModel model, std::uint64_t seed,
                                           double between_people);

}  // namespace dts::physics
