// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dts::physics {

/// Body measures that a reaching task needs (thesis Table 6.1).
struct Person {
  double weight_kg = 70.0;
  double height_cm = 175.0;
  double arm_length_cm = 68.0;  ///< Acromion to third metacarpal head.
  double max_reach_cm = 125.0;  ///< Acromion to the farthest target reached without lifting from the seat.
  /// After a stroke the trunk also moves where the arm alone could reach the target; then distance says little about flexion.
  bool has_stroke = false;
};

/// Returns the trunk flexion, deg, that a reach needs for a target at `target_cm` from the acromion at shoulder height: 0 within 1.15 arm
/// lengths, beyond it l1 s + p s^2 = D - 1.15 AL with s = sin(phi) <= 0.97 (reach-model section 3). Returns NaN if a measure is not
/// positive and finite.
/// Thread: any. Realtime-safe: yes.
[[nodiscard]] double trunk_flexion_deg(const Person& person, double target_cm) noexcept;

/// Borders between the classes, halfway between the windows of thesis Table 6.3.
inline constexpr double kModerateFromDeg = 15.25;
inline constexpr double kMaximumFromDeg = 42.2;

}  // namespace dts::physics
