// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dts::physics {

/// What a reaching task asks about its subject (thesis Table 6.1).
struct Person {
  double weight_kg = 70.0;
  double height_cm = 175.0;
  double arm_length_cm = 68.0;  ///< Acromion to third metacarpal head.
  double max_reach_cm = 125.0;  ///< Acromion to the farthest target reached without lifting from the seat.
  /// After a stroke the trunk helps where the arm alone would reach: distance then says little about flexion.
  bool has_stroke = false;
};

/// Trunk flexion, deg, that a reach to a target at `target_cm` from the acromion at shoulder height takes: 0 within 1.15 arm lengths, from
/// there l1 s + p s^2 = D - 1.15 AL with s = sin(phi) <= 0.97 (reach-model section 3). NaN when a measure is not positive and finite.
/// Thread: any. Realtime-safe: yes.
[[nodiscard]] double trunk_flexion_deg(const Person& person, double target_cm) noexcept;

/// Between the classes, halfway between the windows of thesis Table 6.3.
inline constexpr double kModerateFromDeg = 15.25;
inline constexpr double kMaximumFromDeg = 42.2;

}  // namespace dts::physics
