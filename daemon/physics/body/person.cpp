// SPDX-License-Identifier: Apache-2.0
#include "physics/body/person.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "physics/body/two_link.h"

namespace dts::physics {
namespace {

constexpr double kFingertip = 1.15;           // relative to the arm's length: the hand beyond the third metacarpal head
constexpr double kShoulderAndPelvisM = 0.06;  // p: protraction of the shoulder and roll of the pelvis
constexpr double kLargestSine = 0.97;

bool is_measure(double value) noexcept { return std::isfinite(value) && value > 0.0; }

}  // namespace

double trunk_flexion_deg(const Person& person, double target_cm) noexcept {
  if (!is_measure(person.height_cm) || !is_measure(person.arm_length_cm) || !is_measure(target_cm)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const double beyond_arm_m = (target_cm - kFingertip * person.arm_length_cm) / kCentimetresPerMetre;
  if (beyond_arm_m <= 0.0) return 0.0;
  const double l1 = kTrunkPartOfHeight * person.height_cm / kCentimetresPerMetre;
  // The positive root of p s^2 + l1 s = beyond, in the form that stays exact for small values.
  const double sine = 2.0 * beyond_arm_m / (l1 + std::sqrt(l1 * l1 + 4.0 * kShoulderAndPelvisM * beyond_arm_m));
  return std::asin(std::min(sine, kLargestSine)) * 180.0 / std::numbers::pi;
}

}  // namespace dts::physics
