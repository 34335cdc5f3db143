// SPDX-License-Identifier: Apache-2.0
#include "lab/replay/event_check.h"

#include <gtest/gtest.h>

#include "dts/wire/event_json.h"
#include "events/make.h"
#include "support/event_text.h"

namespace dts::lab::replay {
namespace {

core::ReachEvent reach(std::uint32_t number, core::ReachStep step, double p3_mm = 4.0) {
  return {.step = step, .number = number, .scan = {100 * number}, .p3 = {.scan = {90 * number}, .value_mm = p3_mm}};
}
core::ClassEvent movement(std::uint32_t number) { return {.number = number, .scan = {100 * number}}; }

/// As it was recorded: through the text in the file.
v1::Event recorded(const core::Event& event) {
  v1::Event made = events::make(event, "");
  made.set_host_time_ns(123);  // differs in every replay
  return wire::event_of_json(wire::to_json(made)).value();
}

/// Two reaches with their classes, recorded frame by frame.
void add_two_recorded(EventCheck& check) {
  for (const std::uint32_t number : {1U, 2U}) {
    check.add_recorded(recorded(reach(number, core::ReachStep::Final)));
    check.add_recorded(recorded(movement(number)));
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
  check.add_recorded(test::event_of("marker {}"));
  check.add_computed(two_computed());
  check.finish(false);

  EXPECT_EQ(check.compared(), 4U);
  EXPECT_FALSE(check.difference());
}

TEST(EventCheck, FirstDifference_IsToldWithBothSides) {
  struct Sides {
    bool is_recorded;
    std::optional<double> computed_mm;
    std::uint64_t scan;
    std::string recorded, computed;
  };
  const auto text = [](std::uint32_t number, double p3_mm) {
    return wire::to_json(events::make(reach(number, core::ReachStep::Final, p3_mm), ""));
  };
  const double other_mm = 4.0 + 1e-15;
  for (const auto& [is_recorded, computed_mm, scan, one, other] :
       {Sides{true, other_mm, 200, text(2, 4.0), text(2, other_mm)}, Sides{true, std::nullopt, 100, text(1, 4.0), "none"},
        Sides{false, 4.0, 100, "none", text(1, 4.0)}}) {
    EventCheck check;
    if (computed_mm) check.add_computed(two_computed(*computed_mm));
    if (is_recorded) add_two_recorded(check);
    check.finish(true);
    EXPECT_EQ(check.difference().has_value(), is_recorded && computed_mm) << "what is torn may miss events";
    check.finish(false);

    ASSERT_TRUE(check.difference());
    EXPECT_EQ(check.difference()->segment, 0U);
    EXPECT_EQ(check.difference()->scan, scan);
    EXPECT_EQ(check.difference()->channel, "reach");
    EXPECT_EQ(check.difference()->recorded, one);
    EXPECT_EQ(check.difference()->computed, other);
  }
}

}  // namespace
}  // namespace dts::lab::replay
