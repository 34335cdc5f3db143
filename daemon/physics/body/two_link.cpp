// SPDX-License-Identifier: Apache-2.0
#include "physics/body/two_link.h"

#include <cmath>

namespace dts::physics {
namespace {

constexpr double kTrunkPartOfWeight = 0.54;
constexpr double kArmPartOfWeight = 0.054;
constexpr double kArmPartOfHeight = 0.36;

/// Symmetric mass matrix of the two joints.
struct MassMatrix {
  double m11 = 0.0;
  double m12 = 0.0;
  double m22 = 0.0;
};

/// Thesis 5.17, 5.18, 5.20, 5.23, 5.24: the printed (m1+m2) l1^2/4 is (m1/4 + m2) l1^2, the printed m2 l2^2/2 is m2 l2^2/4 and the
/// printed m l1 l2/2 is m2 l1 l2/2, because the arm hangs at the end of the trunk.
MassMatrix mass_matrix(const BodySegments& body, double theta2) noexcept {
  const double arm = body.arm_kg * body.arm_m * body.arm_m / 4.0;
  const double coupling = body.arm_kg * body.trunk_m * body.arm_m / 2.0 * std::cos(theta2);
  const double trunk = (body.trunk_kg / 4.0 + body.arm_kg) * body.trunk_m * body.trunk_m;
  return {.m11 = trunk + arm + 2.0 * coupling, .m12 = arm + coupling, .m22 = arm};
}

/// Moments of the joints without acceleration. Thesis 5.19 and 5.22: the printed (m1+m2) g l1/2 is (m1/2 + m2) g l1, the printed m2 g l1
/// l2/2 is m2 g l2/2.
JointMoments resting_moments(const BodySegments& body, const JointMotion& motion) noexcept {
  const double arm_weight = body.arm_kg * kGravityMPerS2 * body.arm_m / 2.0 * std::cos(motion.theta1 + motion.theta2);
  const double trunk_weight = (body.trunk_kg / 2.0 + body.arm_kg) * body.trunk_m * kGravityMPerS2 * std::cos(motion.theta1);
  const double turning = body.arm_kg * body.trunk_m * body.arm_m / 2.0 * std::sin(motion.theta2);
  const double hip_turning = -turning * (2.0 * motion.theta1_rate + motion.theta2_rate) * motion.theta2_rate;
  const double shoulder_turning = turning * motion.theta1_rate * motion.theta1_rate;  // thesis 5.21
  return {.hip_nm = hip_turning + trunk_weight + arm_weight, .shoulder_nm = shoulder_turning + arm_weight};
}

}  // namespace

BodySegments body_segments(double weight_kg, double height_cm) noexcept {
  const double height_m = height_cm / kCentimetresPerMetre;
  return {.trunk_kg = kTrunkPartOfWeight * weight_kg,
          .arm_kg = kArmPartOfWeight * weight_kg,
          .trunk_m = kTrunkPartOfHeight * height_m,
          .arm_m = kArmPartOfHeight * height_m};
}

JointMoments joint_moments(const BodySegments& body, const JointMotion& motion) noexcept {
  const MassMatrix mass = mass_matrix(body, motion.theta2);
  const JointMoments rest = resting_moments(body, motion);
  return {.hip_nm = rest.hip_nm + mass.m11 * motion.theta1_acceleration + mass.m12 * motion.theta2_acceleration,
          .shoulder_nm = rest.shoulder_nm + mass.m12 * motion.theta1_acceleration + mass.m22 * motion.theta2_acceleration};
}

HipForce hip_force(const BodySegments& body, const JointMotion& motion) noexcept {
  // Second derivatives of thesis 5.9 to 5.12, with l1 instead of the printed l1/2 in those of the arm.
  const double arm_angle = motion.theta1 + motion.theta2;
  const double arm_rate = motion.theta1_rate + motion.theta2_rate;
  const double arm_acceleration = motion.theta1_acceleration + motion.theta2_acceleration;
  const double trunk = (body.trunk_kg / 2.0 + body.arm_kg) * body.trunk_m;
  const double arm = body.arm_kg * body.arm_m / 2.0;
  const double trunk_squared = motion.theta1_rate * motion.theta1_rate;
  const double arm_squared = arm_rate * arm_rate;
  return {.horizontal_n = -trunk * (std::sin(motion.theta1) * motion.theta1_acceleration + std::cos(motion.theta1) * trunk_squared) -
                          arm * (std::sin(arm_angle) * arm_acceleration + std::cos(arm_angle) * arm_squared),
          .vertical_n = trunk * (std::cos(motion.theta1) * motion.theta1_acceleration - std::sin(motion.theta1) * trunk_squared) +
                        arm * (std::cos(arm_angle) * arm_acceleration - std::sin(arm_angle) * arm_squared)};
}

double kinetic_energy_j(const BodySegments& body, const JointMotion& motion) noexcept {
  // Thesis 5.8 prints m2 l1^2/4, and 5.15 prints l1^2/4 and l1 l2/2 in the arm's speed; but the shoulder moves with the full l1.
  const MassMatrix mass = mass_matrix(body, motion.theta2);
  return 0.5 * mass.m11 * motion.theta1_rate * motion.theta1_rate + mass.m12 * motion.theta1_rate * motion.theta2_rate +
         0.5 * mass.m22 * motion.theta2_rate * motion.theta2_rate;
}

double potential_energy_j(const BodySegments& body, const JointMotion& motion) noexcept {
  const double trunk = (body.trunk_kg / 2.0 + body.arm_kg) * body.trunk_m * std::sin(motion.theta1);
  return kGravityMPerS2 * (trunk + body.arm_kg * body.arm_m / 2.0 * std::sin(motion.theta1 + motion.theta2));
}

JointMotion accelerated(const BodySegments& body, JointMotion motion, const JointMoments& moments) noexcept {
  const MassMatrix mass = mass_matrix(body, motion.theta2);
  const JointMoments rest = resting_moments(body, motion);
  const double hip_nm = moments.hip_nm - rest.hip_nm;
  const double shoulder_nm = moments.shoulder_nm - rest.shoulder_nm;
  const double determinant = mass.m11 * mass.m22 - mass.m12 * mass.m12;
  motion.theta1_acceleration = (mass.m22 * hip_nm - mass.m12 * shoulder_nm) / determinant;
  motion.theta2_acceleration = (mass.m11 * shoulder_nm - mass.m12 * hip_nm) / determinant;
  return motion;
}

}  // namespace dts::physics
