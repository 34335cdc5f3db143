// SPDX-License-Identifier: Apache-2.0
#include "sim/stack_person.h"

namespace dts::sim {

core::Result<StackPerson> StackPerson::create(const physics::Stance& stance, const physics::Plate& plate) {
  if (stance.kind == physics::ContactKind::Point) {
    return core::fail(core::ErrorCode::InvalidArgument, "stance: a weight at one point does not sway", "choose two feet or one");
  }
  DTS_TRY_ASSIGN(const auto person, StandingPerson::create(stance, plate));
  return StackPerson(stance, person);
}

StackPerson::StackPerson(const physics::Stance& stance, const StandingPerson& person)
    : person_(person),
      sway_(stance.seed, stance.kind == physics::ContactKind::OneFoot ? kOneFootSway : kTwoFeetSway),
      mass_kg_(stance.load.value / kStandardGravityMPerS2) {}

StandingMoment StackPerson::at(double time_s) noexcept {
  const SwayMotion motion = sway_.motion_at(time_s);
  const StepPhase phase = person_.phase(time_s);
  const double swaying_kg = mass_kg_ * phase.loaded * phase.two_feet;
  return {.contact = person_.at(time_s, motion.cop), .ml_n = swaying_kg * motion.ml_m_per_s2, .ap_n = swaying_kg * motion.ap_m_per_s2};
}

}  // namespace dts::sim
