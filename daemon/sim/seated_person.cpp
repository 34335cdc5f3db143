// SPDX-License-Identifier: Apache-2.0
#include "sim/seated_person.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace dts::sim {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr std::uint64_t kPersonSeed = 0x736974ULL;

// Ranges of the person's random numbers for each purpose; they are far apart, so that no number is used twice.
constexpr std::uint64_t kPauseDraws = 1ULL << 40;
constexpr std::uint64_t kReactionDraws = 1ULL << 41;
constexpr std::uint64_t kUnrestDraws = 1ULL << 42;
constexpr std::uint64_t kPhaseDraws = 1ULL << 43;

struct Target {
  std::string_view condition;
  double part = 0.0;  ///< Fraction of the arm's length; 0: the maximum reach.
};
constexpr std::array kTargets = {Target{"80", 0.8}, Target{"100", 1.0}, Target{"120", 1.2}, Target{"150", 1.5}, Target{"max", 0.0}};

constexpr double kFirstReachAfterS = 4.0;  // after sitting down: extractors need a baseline first
constexpr double kShortestPeriodS = 6.0;
constexpr double kPeriodSpreadS = 3.0;
constexpr double kShortestPauseS = 1.5;
constexpr double kShortestReactionS = 0.2;
constexpr double kLongestReactionS = 0.35;

constexpr double kUnrestSlotS = 5.0;
constexpr double kUnrestWithinS = 3.0;
constexpr double kCalmBeforeS = 1.8;  // a person sits still before a reach
constexpr double kCalmAfterS = 0.4;
constexpr double kLargestShiftMm = 6.0;

// Sitting down and standing up, assumed: the trunk leans forward; the load starts at the front of the seat and ends there.
constexpr double kSitForceS = 0.8;
constexpr double kSitSlideS = 1.5;
constexpr double kSitFromMm = 60.0;
constexpr double kSitOvershoot = 0.10;
constexpr double kSitLeanDeg = 30.0;
constexpr double kStandLeanS = 0.7;
constexpr double kStandForceS = 0.5;
constexpr double kStandToMm = 80.0;
constexpr double kStandPush = 0.12;
constexpr double kStandLeanDeg = 40.0;

constexpr std::array kSwayHz = {0.11, 0.23, 0.41, 0.83};
constexpr double kBreathingHz = 0.25;
constexpr double kHeartHz = 1.1;

double target_cm_of(const physics::Person& person, const Target& target) noexcept {
  return target.part > 0.0 ? target.part * person.arm_length_cm : person.max_reach_cm;
}

/// A bump of height 1 over 0..1.
double hump(double part) noexcept { return part <= 0.0 || part >= 1.0 ? 0.0 : std::sin(std::numbers::pi * part); }

}  // namespace

SeatedPerson::SeatedPerson(const SeatedPersonOptions& options) noexcept
    : options_(options), random_(options.seed ^ kPersonSeed), body_(options.habits.load) {
  if (options_.mode == ReachMode::Auto) plan_next(options_.sit_down_s + kFirstReachAfterS - kShortestPeriodS);
}

void SeatedPerson::plan(const ReachRequest& request) noexcept {
  ++reaches_;
  plan_ = plan_reach(options_.person, options_.habits, request, random_);
}

void SeatedPerson::plan_next(double after_s) noexcept {
  const physics::Person& person = options_.person;
  // Skips targets beyond the person's reach; the last target, the maximum, is always reachable.
  while (target_cm_of(person, kTargets[target_]) > person.max_reach_cm) target_ = (target_ + 1) % kTargets.size();
  const Target& target = kTargets[target_];
  target_ = (target_ + 1) % kTargets.size();
  const double period_s = kShortestPeriodS + kPeriodSpreadS * random_.uniform(kPauseDraws + reaches_);
  const double start_s = std::max(after_s + period_s, plan_ ? plan_->end_s + kShortestPauseS : 0.0);
  plan({.number = reaches_ + 1,
        .start_s = start_s,
        .target_cm = target_cm_of(person, target),
        .condition = target.condition,
        .is_double = options_.has_double_reaches});
  if (plan_->end_s + 0.5 > options_.stand_up_s) plan_.reset();
}

void SeatedPerson::hear(double time_s, bool is_go, double target_cm) noexcept {
  if (options_.mode == ReachMode::Never) return;
  const bool is_under_way = plan_ && plan_->is_felt(time_s);
  if (options_.mode == ReachMode::Auto) {
    options_.mode = ReachMode::Cued;
    if (!is_under_way) plan_.reset();
  }
  if (!is_go || !std::isfinite(target_cm) || target_cm <= 0.0) return;
  const double varied_s = options_.habits.reaction_s + 0.03 * random_.gaussian_pair(kReactionDraws + reaches_).first;
  const double reaction_s = std::clamp(varied_s, kShortestReactionS, kLongestReactionS);
  const double settled_s = options_.sit_down_s + kSettlingS;
  ReachRequest request{.number = reaches_ + 1,
                       .start_s = std::max(time_s, settled_s) + reaction_s,
                       .target_cm = target_cm,
                       .is_double = options_.has_double_reaches};
  if (is_under_way) {
    request.start_s = std::max(request.start_s, plan_->end_s + reaction_s);
    waiting_ = request;
  } else {
    plan(request);
  }
}

void SeatedPerson::advance(double time_s) noexcept {
  while (plan_ && time_s > plan_->end_s + ReachPlan::kMarginS) {
    const double started_s = plan_->on_s;
    if (options_.mode == ReachMode::Auto) {
      plan_next(started_s);
      continue;
    }
    plan_.reset();
    if (waiting_) plan(*waiting_);
    waiting_.reset();
  }
  while (options_.has_fidgets) {
    const double slot_s = options_.sit_down_s + kSettlingS + kUnrestSlotS * static_cast<double>(slots_);
    if (time_s < slot_s) break;
    look_for_unrest(slots_++, slot_s);
  }
}

bool SeatedPerson::must_be_calm_at(double time_s) const noexcept {
  return plan_ && time_s > plan_->on_s - kCalmBeforeS && time_s < plan_->end_s + kCalmAfterS;
}

void SeatedPerson::look_for_unrest(std::uint64_t slot, double slot_s) noexcept {
  const std::uint64_t draw = kUnrestDraws + 8 * slot;
  const double start_s = slot_s + kUnrestWithinS * random_.uniform(draw);
  if (random_.uniform(draw + 1) >= options_.habits.restlessness || must_be_calm_at(start_s)) return;
  const bool is_shift = random_.uniform(draw + 2) < 0.5;
  const double size = random_.uniform(draw + 3);
  unrest_ = {.start_s = start_s,
             .duration_s = 0.8 + 0.5 * random_.uniform(draw + 4),
             .from_mm = unrest_.to_mm,
             .to_mm = is_shift ? kLargestShiftMm * (2.0 * size - 1.0) : unrest_.to_mm,
             .wobble_mm = is_shift ? 1.0 : 2.0 + 4.0 * size,
             .wobble_hz = 1.5 + random_.uniform(draw + 5)};
}

double SeatedPerson::shifted_mm(double time_s) const noexcept {
  const double part = unrest_.duration_s > 0.0 ? (time_s - unrest_.start_s) / unrest_.duration_s : 1.0;
  const double wobble = hump(part) * std::sin(kTurn * unrest_.wobble_hz * (time_s - unrest_.start_s));
  return unrest_.from_mm + (unrest_.to_mm - unrest_.from_mm) * smooth_step(part) + unrest_.wobble_mm * wobble;
}

void SeatedPerson::disturb(SeatLoad& load, double time_s) const noexcept {
  double sway = 0.0;
  for (std::size_t i = 0; i < kSwayHz.size(); ++i) {
    sway += std::sin(kTurn * (kSwayHz[i] * time_s + random_.uniform(kPhaseDraws + (1U << 20U) + i)));
  }
  // Four sines of amplitude 1 have an rms of the square root of 2.
  load.y_mm += options_.habits.sway_mm * sway / std::numbers::sqrt2 + shifted_mm(time_s);
  // The heart has about as much effect as breathing; an assumption, as for the standing person.
  const double breathing = std::sin(kTurn * kBreathingHz * time_s) + 0.7 * std::sin(kTurn * kHeartHz * time_s);
  load.force_n *= 1.0 + options_.habits.breathing * breathing;
}

SeatedState SeatedPerson::at(double time_s) noexcept {
  advance(time_s);
  SeatedState state{.reach = plan_ ? &*plan_ : nullptr};
  const double sitting_s = time_s - options_.sit_down_s;
  const double standing_s = time_s - options_.stand_up_s;  // minus infinity: never
  const double part = smooth_step(sitting_s / kSitForceS) * (1.0 - smooth_step((standing_s - kStandLeanS) / kStandForceS));
  if (part <= 0.0) return state;
  const bool is_reaching = plan_ && plan_->is_felt(time_s);
  state.is_there = true;
  state.load = is_reaching ? seat_load(body_, *plan_, time_s) : body_.load(body_.at_rest(), 0.0);
  state.trunk_deg = is_reaching ? flexion_deg(body_, *plan_, time_s) : -body_.parameters().lean_back_deg;
  disturb(state.load, time_s);
  const double arriving = 1.0 - smooth_step(sitting_s / kSitSlideS);
  const double leaving = smooth_step(standing_s / kStandLeanS);
  const double push = 1.0 + kSitOvershoot * hump(sitting_s / kSitSlideS) + kStandPush * hump(standing_s / kStandLeanS);
  state.load.force_n *= part * push;
  state.load.y_mm += kSitFromMm * arriving + kStandToMm * leaving;
  state.trunk_deg += kSitLeanDeg * arriving + kStandLeanDeg * leaving;
  return state;
}

}  // namespace dts::sim
