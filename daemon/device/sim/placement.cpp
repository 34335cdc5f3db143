// SPDX-License-Identifier: Apache-2.0
#include "device/sim/placement.h"

#include <algorithm>
#include <cmath>

namespace dts::device::sim {
namespace {

/// Returns the finished part of a ramp after `since_s`; the speed is 0 at both ends. A ramp without length is a step.
double gone(double since_s, double ramp_s) noexcept {
  if (since_s <= 0.0) return 0.0;
  const double t = ramp_s > 0.0 ? std::min(since_s / ramp_s, 1.0) : 1.0;
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

Placement placement_at(const PlacementTimes& times, std::size_t count, double time_s) noexcept {
  const double since_s = time_s - times.first_s;
  if (since_s < 0.0) return {};
  const double period_s = 2.0 * times.ramp_s + times.hold_s + times.pause_s;
  const double turn = std::floor(since_s / period_s);
  const auto things = static_cast<double>(count);
  if (!times.repeats && turn >= things) return {.index = count - 1};
  const double in_turn_s = since_s - turn * period_s;
  const double put = times.ramp_s > 0.0 ? gone(in_turn_s, times.ramp_s) : 1.0;
  const double taken = gone(in_turn_s - times.ramp_s - times.hold_s, times.ramp_s);
  return {.index = static_cast<std::size_t>(std::fmod(turn, things)), .part = std::max(0.0, put - taken)};
}

}  // namespace dts::device::sim
