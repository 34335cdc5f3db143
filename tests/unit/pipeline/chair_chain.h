// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <tuple>
#include <vector>

#include "unit/pipeline/reaching_signal.h"

namespace dts::pipeline {

/// Four sensors of the chair (reach-model section 4); the curve is of no account after linearisation.
inline physics::RigModel chair_rig() {
  physics::RigModel rig{.plate = {}, .support = {.kind = physics::SupportKind::Edges}, .sensors = {}};
  for (const auto& [label, x, y] : {std::tuple{"w2", 140.0, 120.0}, {"w5", 260.0, 120.0}, {"w10", 140.0, 220.0}, {"w13", 260.0, 220.0}}) {
    rig.sensors.push_back({.label = label, .position = {{x}, {y}}, .curve = physics::SensorCurve::hoa1405_assumed()});
  }
  return rig;
}

/// The stage alone, on a transient.
inline std::vector<core::ReachEvent> reaches_of(const Signal& transient, std::size_t block_size = 16) {
  StageSurroundings surroundings(chair_rig());
  const auto stage = surroundings.make({.id = "reach", .options = {}});
  return prepare_and_run(*stage, transient, block_size).reaches;
}

/// What the stage `transient` makes of deflections.
inline Signal transient_from(const Signal& deflections) {
  StageSurroundings surroundings(chair_rig());
  const auto stage = surroundings.make({.id = "transient", .options = {}});
  const core::StreamFormat format = stage->prepare(deflections.format, 64).value();
  const std::size_t block_size = 64;
  Output output = run(*stage, format.channels.size(), deflections, std::span(&block_size, 1));
  return {.format = format, .values = std::move(output.values), .bits = std::move(output.bits)};
}

/// Last Final of each number that was not cancelled.
inline std::vector<core::ReachEvent> finals_of(const std::vector<core::ReachEvent>& events) {
  std::vector<core::ReachEvent> finals;
  for (const core::ReachEvent& event : events) {
    std::erase_if(finals, [&](const core::ReachEvent& other) {
      return other.number == event.number && (event.step == core::ReachStep::Final || event.step == core::ReachStep::Cancelled);
    });
    if (event.step == core::ReachStep::Final) finals.push_back(event);
  }
  return finals;
}

}  // namespace dts::pipeline
