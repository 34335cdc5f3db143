// SPDX-License-Identifier: Apache-2.0
#include "physics/standing_person.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "physics/body/reach_motion.h"

namespace dts::physics {
namespace {

using core::ErrorCode;

// Assumed foot: the heel's pressure centre is 15 % and the ball's 70 % of the foot length from the end of the heel.
constexpr double kHeelToForefoot = 0.55;
constexpr core::Millimetres kHeelWidth{60.0};
constexpr core::Millimetres kHeelLength{60.0};
constexpr core::Millimetres kForefootWidth{90.0};
constexpr core::Millimetres kForefootLength{70.0};

// Assumed small variations of a person's weight on a plate that does not move: breathing and heart beat.
constexpr double kBreathingPart = 0.0015;
constexpr double kBreathsHz = 0.25;
constexpr double kHeartPart = 0.002;
constexpr double kHeartBeatsHz = 1.1;

bool is_on_plate(const Patch& patch, const Plate& plate) noexcept {
  const double half_width = patch.width.value / 2.0;
  const double half_height = patch.height.value / 2.0;
  return patch.centre.x.value - half_width >= 0.0 && patch.centre.x.value + half_width <= plate.a.value &&
         patch.centre.y.value - half_height >= 0.0 && patch.centre.y.value + half_height <= plate.b.value;
}

std::string mm(core::Millimetres length) { return std::to_string(length.value) + " mm"; }

core::Status check_values(const Stance& stance) {
  if (!(stance.load.value > 0.0) || !std::isfinite(stance.load.value)) {
    return core::fail(ErrorCode::InvalidArgument, "stance: load of " + std::to_string(stance.load.value) + " N is not positive");
  }
  const bool has_shape = stance.width.value > 0.0 && stance.foot_length.value > 0.0;
  if (stance.kind == ContactKind::Feet && !has_shape) {
    return core::fail(ErrorCode::InvalidArgument,
                      "stance: width of " + mm(stance.width) + " and foot length of " + mm(stance.foot_length) + " must both be positive");
  }
  const double arrival_s = StandingPerson::kLoadingS + StandingPerson::kShiftS;
  if (!std::isfinite(stance.step_on_s) || !(stance.step_off_s >= stance.step_on_s + arrival_s)) {
    return core::fail(ErrorCode::InvalidArgument, "stance: steps off at " + std::to_string(stance.step_off_s) + " s, but stepping on at " +
                                                      std::to_string(stance.step_on_s) + " s takes " + std::to_string(arrival_s) + " s");
  }
  return {};
}

}  // namespace

core::Result<StandingPerson> StandingPerson::create(const Stance& stance, const Plate& plate) {
  if (auto checked = check_values(stance); !checked) return tl::make_unexpected(checked.error());
  StandingPerson person(stance);
  if (stance.kind == ContactKind::Feet) {
    person.place_feet(plate);
  } else {
    person.place_point(plate);
  }
  for (const Patch& patch : person.patches()) {
    if (is_on_plate(patch, plate)) continue;
    return core::fail(ErrorCode::InvalidArgument,
                      "stance: a contact at x " + mm(patch.centre.x) + ", y " + mm(patch.centre.y) +
                          " (from the corner) does not fit on the " + mm(plate.a) + " x " + mm(plate.b) + " plate",
                      "stand closer to the centre or narrower");
  }
  return person;
}

void StandingPerson::place_feet(const Plate& plate) {
  heel_to_forefoot_mm_ = kHeelToForefoot * stance_.foot_length.value;
  const core::Millimetres x = plate.a / 2.0 + stance_.centre_ml;
  const core::Millimetres y = plate.b / 2.0 + stance_.centre_ap;
  const core::Millimetres half_length{heel_to_forefoot_mm_ / 2.0};
  patch_count_ = 0;
  for (const double side : {-0.5, 0.5}) {
    const core::Millimetres foot = x + stance_.width * side;
    patches_[patch_count_++] = {{foot, y - half_length}, kHeelWidth, kHeelLength};
    patches_[patch_count_++] = {{foot, y + half_length}, kForefootWidth, kForefootLength};
  }
  std::mt19937_64 random(stance_.seed);
  const auto phase = [&random] { return 2.0 * std::numbers::pi * static_cast<double>(random() >> 11) * 0x1p-53; };
  breathing_phase_ = phase();
  heart_phase_ = phase();
}

void StandingPerson::place_point(const Plate& plate) {
  patches_[0] = {{plate.a / 2.0 + stance_.centre_ml, plate.b / 2.0 + stance_.centre_ap}, {}, {}};
  patch_count_ = 1;
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
  if (stance_.kind == ContactKind::Point) {
    contact.load_n = stance_.load.value * now.loaded;
    contact.force_n[0] = contact.load_n;
    return contact;
  }
  const double half_width = stance_.width.value / 2.0;
  const double half_length = heel_to_forefoot_mm_ / 2.0;
  const double standing_ml = std::clamp(sway.ml_mm, -half_width, half_width);
  const double standing_ap = std::clamp(sway.ap_mm, -half_length, half_length);
  const double ml_mm = now.two_feet * (standing_ml + half_width) - half_width;
  const double ap_mm = now.two_feet * standing_ap;
  contact.cop.ml_mm += ml_mm;
  contact.cop.ap_mm += ap_mm;
  contact.load_n = weight_n(time_s) * now.loaded;
  const double right = 0.5 + ml_mm / stance_.width.value;
  const double forefoot = 0.5 + ap_mm / heel_to_forefoot_mm_;
  contact.force_n = {contact.load_n * (1.0 - right) * (1.0 - forefoot), contact.load_n * (1.0 - right) * forefoot,
                     contact.load_n * right * (1.0 - forefoot), contact.load_n * right * forefoot};
  return contact;
}

}  // namespace dts::physics
