// SPDX-License-Identifier: Apache-2.0
#include "record/losses.h"

#include <gtest/gtest.h>

#include "support/event_text.h"

namespace dts::record {
namespace {

using core::GapReason;

using test::event_of;

v1::Event segment(std::uint32_t number, const std::string& reason, std::uint64_t missing) {
  return event_of("segment: " + std::to_string(number) + " segment_start { reason: " + reason +
                  " missing_scans: " + std::to_string(missing) + " }");
}

TEST(LossCounter, CountsSegmentsAfterAGapAndWhatTheRecorderLost_NotWhatWasBeforeTheRecording) {
  LossCounter counter;
  counter.add(segment(3, "GAP_REASON_UNPLUGGED", 900));  // the recording begins here
  counter.add(segment(4, "GAP_REASON_OVERRUN", 500));
  counter.add(event_of("segment: 4 loss { scans: 60 }"));
  counter.add(event_of("segment: 4 gap { missing_scans: 7 }"));
  counter.add(segment(5, "GAP_REASON_OVERRUN", 20));

  EXPECT_EQ(counter.losses().of(GapReason::Overrun), (core::LossCount{.gaps = 2, .scans = 520}));
  EXPECT_EQ(counter.losses().of(GapReason::RingFull), (core::LossCount{.gaps = 1, .scans = 60}));
  EXPECT_EQ(counter.losses().total(), (core::LossCount{.gaps = 3, .scans = 580}));
}

TEST(LossCounter, WhatAFileSaysWrongly_CountsAsAGapOfUnknownReasonAndLength) {
  LossCounter counter;
  counter.add(event_of("segment_start {}"));
  counter.add(event_of("segment_start { reason: 99 }"));
  EXPECT_EQ(counter.losses().of(GapReason::None), (core::LossCount{.gaps = 1, .scans = 0}));
}

TEST(LossesJson, ReadsBackAsItWasWritten) {
  core::Losses losses;
  EXPECT_EQ(to_json(losses), "{}");
  losses.add(GapReason::RingFull, {.gaps = 1, .scans = 10'560});
  losses.add(GapReason::None, {.gaps = 2, .scans = 3});
  const auto back = losses_of_json(to_json(losses));
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, losses);
}

TEST(LossesJson, ReasonsOfALaterVersion_CountAsUnknownOnesAsInAFile) {
  const auto losses = losses_of_json(R"({"stall":{"gaps":1,"scans":2},"magic":{"gaps":1,"scans":3},"more":{"gaps":2,"scans":4}})");
  ASSERT_TRUE(losses);
  EXPECT_EQ(losses->of(GapReason::Stall), (core::LossCount{.gaps = 1, .scans = 2}));
  EXPECT_EQ(losses->of(GapReason::None), (core::LossCount{.gaps = 3, .scans = 7}));
}

TEST(LossesJson, RefusesAnythingElse) {
  for (const char* text : {"", "[]", "7", R"({"stall":3})", R"({"stall":{"gaps":1}})", R"({"stall":{"gaps":-1,"scans":1}})",
                           R"({"stall":{"gaps":1,"scans":"2"}})"}) {
    EXPECT_FALSE(losses_of_json(text)) << text;
  }
}

}  // namespace
}  // namespace dts::record
