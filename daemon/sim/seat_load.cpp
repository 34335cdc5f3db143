// SPDX-License-Identifier: Apache-2.0
#include "sim/seat_load.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "physics/conversions.h"

namespace dts::sim {
namespace {

constexpr double kLeastForceN = 1.0;  // the position of the load is a quotient with the force as divisor

// The back leaves the back rest shortly before the visible movement and touches it again shortly before the end of the movement.
constexpr double kLetGoBeforeS = 0.05;
constexpr double kTakenBeforeEndS = 0.15;
constexpr double kLettingGoS = 0.20;

physics::JointMotion joint_motion(const UpperBody& body) noexcept {
  return {.theta1 = std::numbers::pi / 2.0 - body.flexion.position,
          .theta2 = body.arm.position - (std::numbers::pi / 2.0 - body.flexion.position),
          .theta1_rate = -body.flexion.rate,
          .theta2_rate = body.arm.rate + body.flexion.rate,
          .theta1_acceleration = -body.flexion.acceleration,
          .theta2_acceleration = body.arm.acceleration + body.flexion.acceleration};
}

SeatLoadParameters upright_in_the_thesis(SeatLoadParameters parameters) noexcept {
  if (parameters.model == SeatLoadModel::Thesis) parameters.lean_back_deg = 0.0;
  return parameters;
}

}  // namespace

SeatedBody::SeatedBody(const SeatLoadParameters& parameters) noexcept
    : parameters_(upright_in_the_thesis(parameters)),
      segments_(physics::body_segments(parameters.weight_kg, parameters.height_cm)),
      rest_force_n_(parameters_.rest_force_n.value_or(parameters.seat_part * parameters.weight_kg * physics::kGravityMPerS2)),
      back_moment_nm_((segments_.trunk_kg / 2.0 + segments_.arm_kg) * segments_.trunk_m * physics::kGravityMPerS2 *
                      std::sin(-parameters_.lean_back_deg * physics::kRadiansPerDegree)),
      rest_moment_nm_(hip_moment_nm(at_rest())) {}

UpperBody SeatedBody::at_rest() const noexcept {
  return {.flexion = {.position = -parameters_.lean_back_deg * physics::kRadiansPerDegree},
          .arm = {.position = kArmOnThighDeg * physics::kRadiansPerDegree}};
}

UpperBody SeatedBody::on_the_way(const Travel& progress, double flexion_deg, bool moves_trunk) const noexcept {
  UpperBody body = at_rest();
  body.arm = body.arm + -kArmOnThighDeg * physics::kRadiansPerDegree * progress;
  if (moves_trunk) body.flexion = body.flexion + (flexion_deg + parameters_.lean_back_deg) * physics::kRadiansPerDegree * progress;
  return body;
}

double SeatedBody::hip_moment_nm(const UpperBody& body) const noexcept {
  return physics::joint_moments(segments_, joint_motion(body)).hip_nm;
}

SeatLoad SeatedBody::load(const UpperBody& body, double lift) const noexcept {
  const double moment_nm = hip_moment_nm(body);
  if (parameters_.model == SeatLoadModel::Thesis) {
    const double force_n = rest_force_n_ + parameters_.moment_gain_n_per_nm * (moment_nm - rest_moment_nm_);
    return {.force_n = std::max(force_n, kLeastForceN), .is_uniform = true};
  }
  // At rest the back rest carries its part. The part that it releases presses backwards on the seat: the dip of the initiation stage.
  const double change_nm = moment_nm - back_moment_nm_ * (1.0 - lift) - (rest_moment_nm_ - back_moment_nm_);
  const double to_feet_n = parameters_.moment_to_feet * std::max(change_nm, 0.0) / parameters_.feet_lever_m;
  const double vertical_n = physics::hip_force(segments_, joint_motion(body)).vertical_n;
  const double force_n = std::max(rest_force_n_ + vertical_n - to_feet_n, kLeastForceN);
  return {.force_n = force_n,
          .y_mm = parameters_.rest_y_mm + physics::kMillimetresPerMetre * parameters_.moment_to_place * change_nm / force_n};
}

double back_rest_lift(double time_s, double end_s, double flexion_deg, double lifting_deg) noexcept {
  const double most = std::clamp(flexion_deg / lifting_deg, 0.0, 1.0);
  return most * smooth_step((time_s + kLetGoBeforeS) / kLettingGoS) *
         (1.0 - smooth_step((time_s - (end_s - kTakenBeforeEndS)) / kLettingGoS));
}

}  // namespace dts::sim
