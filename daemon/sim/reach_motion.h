// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

namespace dts::sim {

/// Position, speed and acceleration.
struct Travel {
  double position = 0.0;
  double rate = 0.0;
  double acceleration = 0.0;

  friend constexpr Travel operator+(const Travel& a, const Travel& b) noexcept {
    return {a.position + b.position, a.rate + b.rate, a.acceleration + b.acceleration};
  }
  friend constexpr Travel operator*(double factor, const Travel& travel) noexcept {
    return {factor * travel.position, factor * travel.rate, factor * travel.acceleration};
  }
};

/// Cycloid of thesis 5.5 from 0 to 1 in `duration_s`, at rest before and after: t/T - sin(2 pi t/T)/(2 pi).
/// Thread: any. Realtime-safe: yes.
[[nodiscard]] inline Travel cycloid(double time_s, double duration_s) noexcept {
  if (!(time_s > 0.0)) return {};
  if (time_s >= duration_s) return {.position = 1.0};
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const double part = time_s / duration_s;
  const double sine = std::sin(kTurn * part);
  return {.position = part - sine / kTurn,
          .rate = (1.0 - std::cos(kTurn * part)) / duration_s,
          .acceleration = kTurn * sine / (duration_s * duration_s)};
}

/// Moves to 1 in one phase and back to 0 in another: `phase_s` is the duration of ONE phase (0.75 s in the thesis's figures).
[[nodiscard]] inline Travel there_and_back(double time_s, double phase_s) noexcept {
  return cycloid(time_s, phase_s) + -1.0 * cycloid(time_s - phase_s, phase_s);
}

/// Returns 0 before 0 and 1 after 1, with speed 0 at both ends.
[[nodiscard]] inline double smooth_step(double part) noexcept {
  const double t = part < 0.0 ? 0.0 : (part > 1.0 ? 1.0 : part);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace dts::sim
