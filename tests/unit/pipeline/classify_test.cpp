// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/classify.h"

#include <gtest/gtest.h>

#include "unit/pipeline/floor_rig.h"
#include "unit/pipeline/reaching_signal.h"

namespace dts::pipeline {
namespace {

core::ReachEvent reach(std::uint32_t number, core::ReachStep step, double relative_d2) {
  return {.step = step,
          .number = number,
          .segment = 3,
          .scan = {100 * number},
          .host_time_ns = 7,
          .features = classifier::reach_of(relative_d2)};
}

TEST(Classify, FinalReach_IsJudgedAsTheModelSays) {
  StageSurroundings surroundings;
  const auto stage = surroundings.make({.id = "classify", .options = {}});
  core::FrameEvents events;
  for (const auto step : {core::ReachStep::P1, core::ReachStep::P2, core::ReachStep::P3, core::ReachStep::Cancelled})
    events.reaches.push(reach(9, step, 0.3));
  const std::size_t first = events.reaches.count;
  for (const auto& [number, part] : {std::pair{1U, 0.1}, {2U, 0.5}, {3U, 0.3}})
    events.reaches.push(reach(number, core::ReachStep::Final, part));
  events.reaches.events[first + 2].flags = core::reach_flag::kImplausible;

  stage->tell(events);

  ASSERT_EQ(events.classes.count, 3U);
  for (std::size_t k = 0; k < 3; ++k) {
    const core::ClassEvent& event = events.classes.events[k];
    const core::ReachEvent& judged = events.reaches.events[first + k];
    const core::TrunkMovement expected = surroundings.trunk_model->classify(judged.features, judged.flags);
    EXPECT_EQ(event.number, k + 1);
    EXPECT_EQ(event.segment, 3U);
    EXPECT_EQ(event.scan.value, 100 * (k + 1));
    EXPECT_EQ(event.host_time_ns, 7);
    EXPECT_EQ(event.movement.trunk_class, expected.trunk_class);
    EXPECT_EQ(event.movement.probability, expected.probability);
    EXPECT_EQ(event.movement.reasons, expected.reasons);
  }
  EXPECT_EQ(events.classes.events[1].movement.trunk_class, core::TrunkClass::Maximum);
  EXPECT_EQ(events.classes.events[2].movement.trunk_class, core::TrunkClass::Rejected);
}

}  // namespace
}  // namespace dts::pipeline
