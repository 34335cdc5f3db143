// SPDX-License-Identifier: Apache-2.0
#include "sim/sitting_habits.h"

#include <algorithm>
#include <cmath>

#include "sim/counter_random.h"

namespace dts::sim {
namespace {

constexpr std::uint64_t kHabitSeed = 0x6861626974ULL;
constexpr double kMostBetweenPeople = 2.0;
constexpr double kFarthestDraw = 2.5;  // in standard deviations: limits extreme people

/// Draws the random deviations of one person, one trait after the other.
class HabitDraws {
 public:
  HabitDraws(std::uint64_t seed, double scale) noexcept : random_(seed ^ kHabitSeed), scale_(scale) {}

  double around(double mean, double deviation) noexcept {
    const double draw = std::clamp(random_.gaussian_pair(next_++).first, -kFarthestDraw, kFarthestDraw);
    return mean + scale_ * deviation * draw;
  }

 private:
  CounterRandom random_;
  double scale_;
  std::uint64_t next_ = 0;
};

void draw_load(SittingHabits& habits, HabitDraws& draws) {
  SeatLoadParameters& load = habits.load;
  load.seat_part = draws.around(load.seat_part, 0.015);
  load.lean_back_deg = std::max(draws.around(load.lean_back_deg, 0.7), 0.0);
  load.rest_y_mm = draws.around(load.rest_y_mm, 3.5);
  load.moment_to_place = draws.around(load.moment_to_place, 0.02);
  load.moment_to_feet = draws.around(load.moment_to_feet, 0.02);
  habits.contact.off_centre_mm = draws.around(0.0, 3.0);
  habits.rest_y_deviation_mm = 1.0;
}

/// Limits the use of the arm. The angles of S1 to S5 at the critical boundary (thesis Table 6.4) correspond to 0.55 to 0.82, but a maximum
/// reach must not need more flexion than that of a healthy person.
double plausible_arm_use(physics::Person person, double arm_use) noexcept {
  constexpr double kMostHealthyFlexionDeg = 60.0;
  const double arm_length_cm = person.arm_length_cm;
  for (arm_use = std::clamp(arm_use, 0.5, 1.0); arm_use < 1.0; arm_use += 0.01) {
    person.arm_length_cm = arm_use * arm_length_cm;
    if (physics::trunk_flexion_deg(person, person.max_reach_cm) <= kMostHealthyFlexionDeg) return arm_use;
  }
  return 1.0;
}

void draw_movement(SittingHabits& habits, const physics::Person& person, bool is_healthy, HabitDraws& draws) {
  habits.flexion_factor = draws.around(1.0, 0.05);
  habits.flexion_offset_deg = draws.around(0.0, 1.5);
  habits.flexion_midway_deg = draws.around(0.0, 3.0);
  habits.flexion_deviation_deg = is_healthy ? 1.8 : 2.7;
  if (!is_healthy) habits.arm_use = plausible_arm_use(person, draws.around(0.74, 0.10));
  habits.phase_s = is_healthy ? draws.around(0.75, 0.06) : draws.around(1.2, 0.15);
  habits.phase_growth_per_deg = is_healthy ? 0.0125 : 0.014;
  habits.phase_deviation = is_healthy ? 0.10 : 0.12;
  habits.hold_s = is_healthy ? 0.10 : 0.20;
  habits.hold_deviation = 0.6;
  habits.corrections = is_healthy ? 0.07 : 2.0;
  habits.reaction_s = is_healthy ? draws.around(0.26, 0.02) : draws.around(0.30, 0.02);
  habits.tremor_deg = is_healthy ? 0.005 : 0.03;
  habits.tremor_hz = is_healthy ? draws.around(8.0, 0.5) : draws.around(5.0, 0.5);
  habits.sway_mm = is_healthy ? 0.3 : 0.5;
  habits.breathing = 0.0015;
  habits.restlessness = is_healthy ? 0.45 : 0.5;
}

}  // namespace

SittingHabits ideal_habits(const physics::Person& person, SeatLoadModel model, double phase_s) {
  SittingHabits habits{.phase_s = phase_s};
  habits.load.model = model;
  habits.load.weight_kg = person.weight_kg;
  habits.load.height_cm = person.height_cm;
  return habits;
}

SittingHabits natural_habits(const physics::Person& person, bool is_healthy, SeatLoadModel model, std::uint64_t seed,
                             double between_people) {
  SittingHabits habits = ideal_habits(person, model, 0.0);
  HabitDraws draws(seed, std::clamp(between_people, 0.0, kMostBetweenPeople));
  draw_load(habits, draws);
  draw_movement(habits, person, is_healthy, draws);
  return habits;
}

}  // namespace dts::sim
