// SPDX-License-Identifier: Apache-2.0
#include "core/event.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace dts::core {
namespace {

char letter_of(const Event& event) { return "trcs"[event.index()]; }

std::string order_of(const FrameEvents& events) {
  std::string order;
  for_each(events, [&](const Event& event) { order += letter_of(event); });
  return order;
}

ReachEvent reach(ReachStep step, std::uint32_t number, std::uint64_t scan) { return {.step = step, .number = number, .scan = {scan}}; }

TEST(FrameEvents, AreInTheOrderOfPublication) {
  FrameEvents events;
  events.sways.push({});
  events.classes.push({.number = 1, .scan = {9}});
  events.reaches.push(reach(ReachStep::Final, 1, 9));
  events.triggers.push({});
  events.triggers.push({});
  EXPECT_EQ(order_of(events), "ttrcs");
}

TEST(FrameEvents, AClassComesRightAfterTheFinalStepOfItsReach) {
  using enum ReachStep;
  const struct {
    std::vector<ReachEvent> reaches;
    std::vector<std::pair<std::uint32_t, std::uint64_t>> classes;  // number, scan
    std::string order;
  } rows[]{
      {{reach(P1, 1, 5), reach(Final, 1, 9)}, {{1, 9}}, "rrc"},  {{reach(Final, 1, 9), reach(P1, 2, 9), reach(P2, 2, 9)}, {{1, 9}}, "rcrr"},
      {{reach(P3, 1, 9), reach(Final, 1, 9)}, {{1, 9}}, "rrc"},  {{reach(Final, 2, 9)}, {{1, 8}, {2, 9}, {3, 10}}, "crcc"},
      {{reach(Final, 1, 9), reach(P1, 2, 10)}, {{3, 9}}, "rcr"}, {{}, {{1, 3}}, "c"},
  };
  for (const auto& row : rows) {
    FrameEvents events;
    for (const ReachEvent& event : row.reaches) events.reaches.push(event);
    for (const auto& [number, scan] : row.classes) events.classes.push({.number = number, .scan = {scan}});
    EXPECT_EQ(order_of(events), row.order);
  }
}

TEST(FrameEvents, WhatFindsNoRoomIsCounted) {
  FrameEvents events;
  for (std::uint64_t scan = 0; scan < 18; ++scan) events.triggers.push({.scan = {scan}});
  EXPECT_EQ(events.lost(), 2U);
  EXPECT_EQ(events.triggers.all_of().back().scan.value, 15U);
  events.clear();
  EXPECT_EQ(events.lost(), 0U);
  EXPECT_EQ(order_of(events), "");
}

}  // namespace
}  // namespace dts::core
