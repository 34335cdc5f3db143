// SPDX-License-Identifier: Apache-2.0
#include "sim/reach_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "physics/conversions.h"

namespace dts::sim {
namespace {

constexpr double kMostFlexionDeg = 75.0;
constexpr double kLeastFlexionDeg = 1.4;  // smaller flexions come from the shoulder: the trunk stays at the back rest
constexpr double kMidwayOfDeg = 60.0;
constexpr double kShortestPhaseS = 0.3;
constexpr double kOverlap = 1.6;       // a correction starts before the previous move ends
constexpr std::size_t kMostParts = 5;  // of one phase
constexpr double kTurnedBack = 0.7;    // fraction of the way, between the two halves of a double reach
constexpr std::uint64_t kDrawsPerReach = 64;

/// Random variation of one reach.
class ReachDraws {
 public:
  ReachDraws(const CounterRandom& random, std::uint32_t reach) noexcept : random_(random), next_(reach * kDrawsPerReach) {}
  double gaussian() noexcept { return std::clamp(random_.gaussian_pair(next_++).first, -2.5, 2.5); }
  double uniform() noexcept { return random_.uniform(2 * next_++); }

 private:
  const CounterRandom& random_;
  std::uint64_t next_;
};

double planned_flexion_deg(physics::Person person, const SittingHabits& habits, double target_cm, ReachDraws& draws) noexcept {
  const double deviation_deg = habits.flexion_deviation_deg * draws.gaussian();
  person.arm_length_cm *= habits.arm_use;
  const double needed_deg = physics::trunk_flexion_deg(person, target_cm);
  if (!(needed_deg > 0.0)) return 0.0;
  const double part = std::min(needed_deg / kMidwayOfDeg, 1.0);
  const double habit_deg = habits.flexion_offset_deg + 4.0 * part * (1.0 - part) * habits.flexion_midway_deg;
  // Small movements vary little.
  const double sure = std::min(needed_deg / 8.0, 1.0);
  const double flexion_deg = needed_deg * habits.flexion_factor + habit_deg + (0.5 + 0.5 * sure) * deviation_deg;
  return flexion_deg < kLeastFlexionDeg ? 0.0 : std::min(flexion_deg, kMostFlexionDeg);
}

/// Draws a binomial number with the habit's mean.
std::size_t part_count(double corrections, ReachDraws& draws) noexcept {
  std::size_t count = 1;
  for (std::size_t i = 1; i < kMostParts; ++i) {
    count += draws.uniform() < corrections / static_cast<double>(kMostParts - 1) ? 1 : 0;
  }
  return count;
}

/// Adds `amount` of the way within `duration_s`, in `count` parts.
void add_phase(ReachPlan& plan, double start_s, double duration_s, double amount, std::size_t count, ReachDraws& draws) noexcept {
  count = std::clamp<std::size_t>(count, 1, ReachPlan::kMostMoves - plan.move_count);
  std::array<double, kMostParts> weights{};
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) sum += weights[i] = 0.4 + draws.uniform();
  const double step_s = duration_s / (static_cast<double>(count - 1) + kOverlap);
  for (std::size_t i = 0; i < count; ++i) {
    plan.moves[plan.move_count++] = {
        .start_s = start_s + static_cast<double>(i) * step_s, .duration_s = kOverlap * step_s, .amount = amount * weights[i] / sum};
  }
}

/// Adds the tremor of `plan` to the flexion and both its derivatives; it grows and fades with the movement.
void add_tremor(UpperBody& body, const ReachPlan& plan, double time_s, double progress) noexcept {
  if (plan.tremor_deg == 0.0 || !plan.moves_trunk) return;
  const double wave = 2.0 * std::numbers::pi * plan.tremor_hz;
  const double size = plan.tremor_deg * physics::kRadiansPerDegree * std::clamp(progress, 0.0, 1.0);
  const double phase = wave * (time_s - plan.on_s);
  body.flexion = body.flexion + Travel{.position = size * std::sin(phase),
                                       .rate = size * wave * std::cos(phase),
                                       .acceleration = -size * wave * wave * std::sin(phase)};
}

UpperBody body_at(const SeatedBody& body, const ReachPlan& plan, double time_s) noexcept {
  const Travel progress = plan.progress(time_s);
  UpperBody upper = body.on_the_way(progress, plan.trunk_deg, plan.moves_trunk);
  add_tremor(upper, plan, time_s, progress.position);
  return upper;
}

}  // namespace

Travel ReachPlan::progress(double time_s) const noexcept {
  Travel sum;
  for (std::size_t i = 0; i < move_count; ++i) sum = sum + moves[i].amount * cycloid(time_s - moves[i].start_s, moves[i].duration_s);
  return sum;
}

double ReachPlan::lift(double time_s, double lifting_deg) const noexcept {
  return moves_trunk ? back_rest_lift(time_s - on_s, end_s - on_s, trunk_deg, lifting_deg) : 0.0;
}

ReachPlan plan_reach(const physics::Person& person, const SittingHabits& habits, const ReachRequest& request,
                     const CounterRandom& random) noexcept {
  ReachDraws draws(random, request.number);
  ReachPlan plan{.number = request.number, .target_cm = request.target_cm, .condition = request.condition, .on_s = request.start_s};
  plan.trunk_deg = planned_flexion_deg(person, habits, request.target_cm, draws);
  plan.moves_trunk = plan.trunk_deg > 0.0;
  if (request.trunk_deg) {
    plan.trunk_deg = *request.trunk_deg;
    plan.moves_trunk = true;
  }
  plan.tremor_deg = habits.tremor_deg;
  plan.tremor_hz = habits.tremor_hz;
  const double usual_s = habits.phase_s * (1.0 + habits.phase_growth_per_deg * std::max(plan.trunk_deg, 0.0));
  const auto phase_s = [&] { return std::max(usual_s * (1.0 + habits.phase_deviation * draws.gaussian()), kShortestPhaseS); };
  const auto hold_s = [&] { return habits.hold_s * std::max(1.0 + habits.hold_deviation * draws.gaussian(), 0.1); };
  const auto go = [&](double from_s, double amount) {
    const double duration_s = phase_s() * (request.is_double && std::abs(amount) < 1.0 ? kTurnedBack : 1.0);
    add_phase(plan, from_s, duration_s, amount, part_count(habits.corrections, draws), draws);
    return from_s + duration_s;
  };
  plan.hit_s = go(plan.on_s, 1.0);
  if (request.is_double) {
    const double turned_s = go(plan.hit_s + hold_s(), -kTurnedBack);
    plan.hit_s = go(turned_s + hold_s(), kTurnedBack);
  }
  plan.back_s = plan.hit_s + hold_s();
  plan.end_s = go(plan.back_s, -1.0);
  return plan;
}

SeatLoad seat_load(const SeatedBody& body, const ReachPlan& plan, double time_s) noexcept {
  return body.load(body_at(body, plan, time_s), plan.lift(time_s, body.parameters().lifting_deg));
}

double flexion_deg(const SeatedBody& body, const ReachPlan& plan, double time_s) noexcept {
  return body_at(body, plan, time_s).flexion.position / physics::kRadiansPerDegree;
}

}  // namespace dts::sim
