// SPDX-License-Identifier: Apache-2.0
#include "record/reach_record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dts::record {
namespace {

core::ReachEvent final_reach() {
  core::ReachEvent event{.step = core::ReachStep::Final, .number = 7, .segment = 2, .scan = {123'456'789'012}};
  event.p1 = {.scan = {123'456'780'000}, .value_mm = 1.0 / 3.0};
  event.p2 = {.scan = {123'456'781'000}, .value_mm = 0.1};
  event.p3 = {.scan = {123'456'782'000}, .value_mm = 4.0};
  event.features = {.p1_mm = 1.0 / 3.0,
                    .p2_mm = 0.1,
                    .p3_mm = 4.0,
                    .hold_mm = 3.3,
                    .rise_s = 0.62,
                    .rest_ratio = -0.2,
                    .ratio_change = 0.05,
                    .twist = 1e-17,
                    .smoothness = -1.6};
  event.flags = 0xFFFF;
  event.resumed = 3;
  return event;
}

/// As it comes back from a file.
RecordedEvent through_json(const RecordedEvent& event) { return event_of_json(to_json(event)).value(); }

void set(RecordedEvent& event, const std::string& key, EventValue value) {
  std::ranges::find(event.values, key, &std::pair<std::string, EventValue>::first)->second = std::move(value);
}

TEST(ReachRecord, FinalReach_ComesBackToTheLastBit) {
  const core::ReachEvent written = final_reach();

  const auto read = reach_of(through_json(to_record(written)));

  ASSERT_TRUE(read);
  EXPECT_EQ(read->step, written.step);
  EXPECT_EQ(read->number, written.number);
  EXPECT_EQ(read->segment, written.segment);
  EXPECT_EQ(read->scan, written.scan);
  EXPECT_EQ(read->p1, written.p1);
  EXPECT_EQ(read->p2, written.p2);
  EXPECT_EQ(read->p3, written.p3);
  EXPECT_EQ(read->features.p3_mm, written.features.p3_mm);
  EXPECT_EQ(read->features.hold_mm, written.features.hold_mm);
  EXPECT_EQ(read->features.rise_s, written.features.rise_s);
  EXPECT_EQ(read->features.rest_ratio, written.features.rest_ratio);
  EXPECT_EQ(read->features.ratio_change, written.features.ratio_change);
  EXPECT_EQ(read->features.twist, written.features.twist);
  EXPECT_EQ(read->features.smoothness, written.features.smoothness);
  EXPECT_EQ(read->flags, written.flags);
  EXPECT_EQ(read->resumed, written.resumed);
}

TEST(ReachRecord, ProvisionalReach_KeepsWhatIsNotKnownUnknown) {
  const core::ReachEvent written{.step = core::ReachStep::P1, .number = 1, .p1 = {.scan = {10}, .value_mm = 3.0}};

  const auto read = reach_of(through_json(to_record(written)));

  ASSERT_TRUE(read);
  EXPECT_EQ(read->p1.value_mm, 3.0);
  EXPECT_TRUE(std::isnan(read->p3.value_mm));
  EXPECT_TRUE(std::isnan(read->features.smoothness));
}

TEST(ReachRecord, DamagedReach_IsRefusedWithItsKey) {
  const auto refusal_of = [](const std::string& key, EventValue value) {
    RecordedEvent event = to_record(final_reach());
    set(event, key, std::move(value));
    const auto read = reach_of(event);
    return read ? std::string("accepted") : read.error().what;
  };

  EXPECT_NE(refusal_of("step", std::string("p4")).find("\"step\""), std::string::npos);
  EXPECT_NE(refusal_of("number", std::int64_t{-1}).find("\"number\""), std::string::npos);
  EXPECT_NE(refusal_of("number", std::int64_t{1} << 40U).find("\"number\""), std::string::npos);
  EXPECT_NE(refusal_of("flags", std::int64_t{65536}).find("\"flags\""), std::string::npos);
  EXPECT_NE(refusal_of("p2_scan", 1.5).find("\"p2_scan\""), std::string::npos);
  EXPECT_NE(refusal_of("rise_s", std::string("long")).find("\"rise_s\""), std::string::npos);
  RecordedEvent without = to_record(final_reach());
  std::erase_if(without.values, [](const auto& value) { return value.first == "twist"; });
  EXPECT_FALSE(reach_of(without));
}

TEST(ReachRecord, Class_ComesBackToTheLastBit) {
  const core::ClassEvent written{.number = 4,
                                 .segment = 1,
                                 .scan = {99},
                                 .movement = {.trunk_class = core::TrunkClass::Rejected,
                                              .probability = {0.1, 0.2, 0.7},
                                              .trunk_deg = 25.0,
                                              .trunk_lo_deg = 1.0 / 7.0,
                                              .trunk_hi_deg = std::numeric_limits<double>::quiet_NaN(),
                                              .reasons = core::class_reason::kUnsure}};

  const auto read = class_of(through_json(to_record(written)));

  ASSERT_TRUE(read);
  EXPECT_EQ(read->number, 4U);
  EXPECT_EQ(read->movement.trunk_class, core::TrunkClass::Rejected);
  EXPECT_EQ(read->movement.probability, written.movement.probability);
  EXPECT_EQ(read->movement.trunk_deg, 25.0);
  EXPECT_EQ(read->movement.trunk_lo_deg, 1.0 / 7.0);
  EXPECT_TRUE(std::isnan(read->movement.trunk_hi_deg));
  EXPECT_EQ(read->movement.reasons, core::class_reason::kUnsure);
}

TEST(ReachRecord, ClassBeyondMaximum_IsRefused) {
  RecordedEvent event = to_record(core::ClassEvent{});
  set(event, "class", std::int64_t{4});

  EXPECT_FALSE(class_of(event));
}

}  // namespace
}  // namespace dts::record
