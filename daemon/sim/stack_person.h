// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/result.h"
#include "physics/plate/plate.h"
#include "physics/stance.h"
#include "sim/standing_person.h"
#include "sim/sway.h"

namespace dts::sim {

/// What a standing person does at one moment, and the shear with which the ground answers.
struct StandingMoment {
  Contact contact;
  double ml_n = 0.0;  ///< Horizontal force of the ground on the person, to the right and forward.
  double ap_n = 0.0;
};

/// A person on two feet or on one who sways, with the shear that accelerates the centre of mass: mass x acceleration of the pendulum of
/// `SwayModel`, which is 1.0 m long. `posturography::ground_reaction` estimates the same force with a length from the body height (1.2 m
/// for 1.75 m), so the two do not agree by construction. Even so, this person is one rigid pendulum: how well that estimate fits real
/// people shows only on recordings. A free moment about the vertical is not simulated. While the person steps on or off, the shear of
/// stepping is not simulated.
///
/// A function of time and seed: two objects with the same parameters give the same person at the same time. Thread: one.
class StackPerson {
 public:
  /// Fails as `StandingPerson::create`, and with InvalidArgument for ContactKind::Point, which does not sway.
  [[nodiscard]] static core::Result<StackPerson> create(const physics::Stance& stance, const physics::Plate& plate);

  /// See `StandingPerson::patches`.
  [[nodiscard]] std::span<const physics::Patch> patches() const noexcept { return person_.patches(); }
  /// `time_s` must not go backwards by more than 1 ms. Realtime-safe: yes; costs two steps per millisecond since the last call.
  [[nodiscard]] StandingMoment at(double time_s) noexcept;

 private:
  StackPerson(const physics::Stance& stance, const StandingPerson& person);

  StandingPerson person_;
  Sway sway_;
  double mass_kg_;
};

}  // namespace dts::sim
