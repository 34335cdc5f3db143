// SPDX-License-Identifier: Apache-2.0
#include "sim/standing_person.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "sim/reach_motion.h"

namespace dts::sim {
namespace {

using core::ErrorCode;

// Assumed small variations of a person's weight on a plate that does not move: breathing and heart beat.
constexpr double kBreathingPart = 0.0015;
constexpr double kBreathsHz = 0.25;
constexpr double kHeartPart = 0.002;
constexpr double kHeartBeatsHz = 1.1;

/// Fails if the person steps off before stepping on is complete.
core::Status check_times(const physics::Stance& stance) {
  const double arrival_s = StandingPerson::kLoadingS + StandingPerson::kShiftS;
  if (!std::isfinite(stance.step_on_s) || !(stance.step_off_s >= stance.step_on_s + arrival_s)) {
    return core::fail(ErrorCode::InvalidArgument, "stance: steps off at " + std::to_string(stance.step_off_s) + " s, but stepping on at " +
                                                      std::to_string(stance.step_on_s) + " s takes " + std::to_string(arrival_s) + " s");
  }
  return {};
}

}  // namespace

core::Result<StandingPerson> StandingPerson::create(const physics::Stance& stance, const physics::Plate& plate) {
  DTS_TRY_ASSIGN(const auto patches, physics::place_stance(stance, plate));
  DTS_TRY(check_times(stance));
  return StandingPerson(stance, patches);
}

StandingPerson::StandingPerson(const physics::Stance& stance, const physics::StancePatches& patches) : stance_(stance), patches_(patches) {
  std::mt19937_64 random(stance_.seed);
  const auto phase = [&random] { return 2.0 * std::numbers::pi * static_cast<double>(random() >> 11) * 0x1p-53; };
  breathing_phase_ = phase();
  heart_phase_ = phase();
}

StepPhase StandingPerson::phase(double time_s) const noexcept {
  const double arriving_s = time_s - stance_.step_on_s;
  const double leaving_s = time_s - stance_.step_off_s;
  const double loaded = smooth_step(arriving_s / kLoadingS);
  const double shifted = smooth_step((arriving_s - kLoadingS) / kShiftS);
  if (leaving_s <= 0.0) return {loaded, shifted};
  return {1.0 - smooth_step((leaving_s - kShiftS) / kLoadingS), 1.0 - smooth_step(leaving_s / kShiftS)};
}

double StandingPerson::weight_n(double time_s) const noexcept {
  const double breathing = kBreathingPart * std::sin(2.0 * std::numbers::pi * kBreathsHz * time_s + breathing_phase_);
  const double heart = kHeartPart * std::sin(2.0 * std::numbers::pi * kHeartBeatsHz * time_s + heart_phase_);
  return stance_.load.value * (1.0 + breathing + heart);
}

Contact StandingPerson::at(double time_s, CopPosition sway) const noexcept {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const StepPhase now = phase(time_s);
  Contact contact;
  contact.cop = {kNone, kNone};
  if (now.loaded <= 0.0) return contact;
  contact.cop = {stance_.centre_ml.value, stance_.centre_ap.value};
  if (stance_.kind == physics::ContactKind::Point) {
    contact.load_n = stance_.load.value * now.loaded;
    contact.force_n[0] = contact.load_n;
    return contact;
  }
  const double half_width = patches_.width_mm / 2.0;
  const double arriving_ml = stance_.kind == physics::ContactKind::OneFoot ? 0.0 : -half_width;
  const double half_length = patches_.heel_to_forefoot_mm / 2.0;
  const double standing_ml = std::clamp(sway.ml_mm, -half_width, half_width);
  const double standing_ap = std::clamp(sway.ap_mm, -half_length, half_length);
  const double ml_mm = now.two_feet * (standing_ml - arriving_ml) + arriving_ml;
  const double ap_mm = now.two_feet * standing_ap;
  contact.cop.ml_mm += ml_mm;
  contact.cop.ap_mm += ap_mm;
  contact.load_n = weight_n(time_s) * now.loaded;
  const double right = 0.5 + ml_mm / patches_.width_mm;
  const double forefoot = 0.5 + ap_mm / patches_.heel_to_forefoot_mm;
  contact.force_n = {contact.load_n * (1.0 - right) * (1.0 - forefoot), contact.load_n * (1.0 - right) * forefoot,
                     contact.load_n * right * (1.0 - forefoot), contact.load_n * right * forefoot};
  return contact;
}

}  // namespace dts::sim
