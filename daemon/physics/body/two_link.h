// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dts::physics {

inline constexpr double kGravityMPerS2 = 9.8;  ///< Value of the thesis.
inline constexpr double kCentimetresPerMetre = 100.0;
inline constexpr double kTrunkPartOfHeight = 0.30;

/// Trunk with head (1) and one arm (2) as point masses in the middle of rigid links; the arm hangs at the END of the trunk.
///
///            2  shoulder
///     theta2 |\ m2 (l2/2)          theta1: trunk from the horizontal, 90 deg upright
///            | \ hand              theta2: arm relative to the trunk
///         m1 |
///            |                     Sheet section 2 corrects the thesis's equations 5.8 to 5.24; each function cites its own.
///           hip ---> x forward
struct BodySegments {
  double trunk_kg = 0.0;
  double arm_kg = 0.0;
  double trunk_m = 0.0;
  double arm_m = 0.0;
};

/// Returns fractions of weight and height after Plagenhoef 1983, mean of men and women as in the thesis. Only one arm counts: the other one
/// rests on the thigh.
[[nodiscard]] BodySegments body_segments(double weight_kg, double height_cm) noexcept;

/// Angles of both links, their rates and accelerations: rad, s.
struct JointMotion {
  double theta1 = 0.0;
  double theta2 = 0.0;
  double theta1_rate = 0.0;
  double theta2_rate = 0.0;
  double theta1_acceleration = 0.0;
  double theta2_acceleration = 0.0;
};

struct JointMoments {
  double hip_nm = 0.0;
  double shoulder_nm = 0.0;
};

/// Force that accelerates the body, without its weight.
struct HipForce {
  double horizontal_n = 0.0;  ///< Forward.
  double vertical_n = 0.0;    ///< Upward, without the weight of the segments.
};

/// Inverse dynamics. Thesis 5.23 and 5.24, corrected. All: Thread: any. Realtime-safe: yes.
[[nodiscard]] JointMoments joint_moments(const BodySegments& body, const JointMotion& motion) noexcept;
[[nodiscard]] HipForce hip_force(const BodySegments& body, const JointMotion& motion) noexcept;
/// Thesis 5.8 and 5.15, corrected.
[[nodiscard]] double kinetic_energy_j(const BodySegments& body, const JointMotion& motion) noexcept;
/// Relative to the hip. Thesis 5.13, 5.14, 5.16, corrected.
[[nodiscard]] double potential_energy_j(const BodySegments& body, const JointMotion& motion) noexcept;
/// Forward dynamics: returns `motion` with the accelerations that `moments` cause.
[[nodiscard]] JointMotion accelerated(const BodySegments& body, JointMotion motion, const JointMoments& moments) noexcept;

}  // namespace dts::physics
