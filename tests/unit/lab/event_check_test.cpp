// SPDX-License-Identifier: Apache-2.0
#include "lab/event_check.h"

#include <gtest/gtest.h>

#include "record/reach_record.h"

namespace dts::lab {
namespace {

core::ReachEvent reach(std::uint32_t number, core::ReachStep step, double p3_mm = 4.0) {
  return {.step = step, .number = number, .scan = {100 * number}, .p3 = {.scan = {90 * number}, .value_mm = p3_mm}};
}
core::ClassEvent movement(std::uint32_t number) { return {.number = number, .scan = {100 * number}}; }

/// As it was recorded: through the text in the file.
record::RecordedEvent recorded(const record::RecordedEvent& event) { return record::event_of_json(record::to_json(event)).value(); }

/// Two reaches with their classes, recorded frame by frame.
void add_two_recorded(EventCheck& check) {
  for (const std::uint32_t number : {1U, 2U}) {
    check.add_recorded(recorded(record::to_record(reach(number, core::ReachStep::Final))));
    check.add_recorded(recorded(record::to_record(movement(number))));
  }
}
/// The same in one frame, so that the reaches come before both classes.
core::FrameEvents two_computed(double second_p3_mm = 4.0) {
  core::FrameEvents events;
  events.reaches.push(reach(1, core::ReachStep::Final));
  events.reaches.push(reach(2, core::ReachStep::Final, second_p3_mm));
  events.classes.push(movement(1));
  events.classes.push(movement(2));
  return events;
}

TEST(EventCheck, SameEventsInOtherFrames_AreIdentical) {
  EventCheck check;
  add_two_recorded(check);
  check.add_computed(two_computed());
  check.finish(false);

  EXPECT_EQ(check.compared(), 4U);
  EXPECT_FALSE(check.difference());
}

TEST(EventCheck, LastDigit_IsADifference) {
  EventCheck check;
  check.add_computed(two_computed(4.0 + 1e-15));
  add_two_recorded(check);
  check.finish(false);

  ASSERT_TRUE(check.difference());
  EXPECT_EQ(check.difference()->scan, 200U);
  EXPECT_EQ(check.difference()->channel, "reach");
}

TEST(EventCheck, MissingOnEitherSide_IsADifferenceUnlessTorn) {
  EventCheck not_computed;
  add_two_recorded(not_computed);
  not_computed.finish(false);
  EventCheck not_recorded;
  not_recorded.add_computed(two_computed());
  not_recorded.finish(false);
  EventCheck torn;
  torn.add_computed(two_computed());
  torn.finish(true);

  EXPECT_TRUE(not_computed.difference());
  EXPECT_TRUE(not_recorded.difference());
  EXPECT_FALSE(torn.difference());
}

TEST(EventCheck, OtherEvents_AreNotItsMatter) {
  EventCheck check;
  check.add_recorded({.event = "marker"});
  check.finish(false);

  EXPECT_EQ(check.compared(), 0U);
  EXPECT_FALSE(check.difference());
}

}  // namespace
}  // namespace dts::lab
