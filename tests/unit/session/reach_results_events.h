// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "session/reach_results.h"

namespace dts::session::made {

/// 100 scans a second. What is told of one reach: P1 at `p1`, P3 60 scans later, final 50 scans after that.
inline constexpr std::uint64_t kToFinal = 110;

inline core::ReachEvent reach(std::uint32_t number, std::uint64_t p1, double d2_mm = 1.0, std::uint32_t segment = 0) {
  core::ReachEvent event{.step = core::ReachStep::Final, .number = number, .segment = segment, .scan = {p1 + kToFinal}};
  event.p1 = {{p1}, 3.0};
  event.p2 = {{p1 + 20}, 2.6};
  event.p3 = {{p1 + 60}, 3.0 + d2_mm};
  event.features.p1_mm = 3.0;
  event.features.p2_mm = 2.6;
  event.features.p3_mm = 3.0 + d2_mm;
  event.features.hold_mm = 0.9 * d2_mm;
  event.features.rise_s = 0.4;
  event.features.rest_ratio = -0.2;
  event.features.ratio_change = 0.2 * d2_mm;
  event.features.twist = 0.0;
  event.features.smoothness = -1.6;
  return event;
}

inline core::ClassEvent classed(const core::ReachEvent& reach, core::TrunkClass trunk_class, double trunk_deg) {
  core::ClassEvent event{.number = reach.number, .segment = reach.segment, .scan = reach.scan};
  event.movement.trunk_class = trunk_class;
  event.movement.probability = {0.2, 0.6, 0.2};
  event.movement.trunk_deg = trunk_deg;
  event.movement.trunk_lo_deg = trunk_deg - 8.0;
  event.movement.trunk_hi_deg = trunk_deg + 8.0;
  return event;
}

inline TrialEvent step(TrialEventKind kind, std::uint32_t trial, std::uint32_t attempt = 1, const std::string& condition = "150",
                       std::optional<double> target_cm = 100.5) {
  return {.kind = kind, .trial = trial, .attempt = attempt, .condition = condition, .target_cm = target_cm};
}

/// Volunteer A of thesis Table 5.1: 80.4, 100.5 and 124 cm take 3.6, 25.2 and 54.9 degrees.
inline physics::Person volunteer() { return {.weight_kg = 68.0, .height_cm = 175.0, .arm_length_cm = 67.0, .max_reach_cm = 124.0}; }

/// Go at `go`, one reach 50 scans later, done at `go` + 500; everything told in order.
inline void tell_trial(ReachResults& results, std::uint32_t trial, std::uint64_t go, const std::string& condition, double target_cm,
                       double d2_mm, core::TrunkClass trunk_class, double trunk_deg) {
  const core::ReachEvent event = reach(trial, go + 50, d2_mm);
  results.take(step(TrialEventKind::Go, trial, 1, condition, target_cm), 0, {go});
  results.take(event);
  results.take(classed(event, trunk_class, trunk_deg));
  results.take(step(TrialEventKind::Done, trial, 1, condition, target_cm), 0, {go + 500});
  results.advance(0, {go + 510});
}

}  // namespace dts::session::made
