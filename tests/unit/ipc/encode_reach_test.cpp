// SPDX-License-Identifier: Apache-2.0
#include "ipc/encode_reach.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dts::ipc {
namespace {

core::ReachEvent final_reach() {
  core::ReachEvent event{.step = core::ReachStep::Final, .number = 3, .segment = 1, .scan = {900}, .host_time_ns = 77};
  event.p1 = {.scan = {600}, .value_mm = 3.3};
  event.p2 = {.scan = {650}, .value_mm = 2.9};
  event.p3 = {.scan = {800}, .value_mm = 4.8};
  event.features = {.p1_mm = 3.3, .p2_mm = 2.9, .p3_mm = 4.8, .hold_mm = 1.2, .rise_s = 0.1};
  event.flags = core::reach_flag::kResumed;
  event.resumed = 1;
  return event;
}

TEST(EncodeReach, Final_SaysWhereAndWhat) {
  const dts::v1::Event event = reach_event(42, final_reach());

  EXPECT_EQ(event.instance_id(), 42U);
  EXPECT_EQ(event.segment(), 1U);
  EXPECT_EQ(event.scan(), 900U);
  EXPECT_EQ(event.host_time_ns(), 77);
  ASSERT_TRUE(event.has_reach());
  EXPECT_EQ(event.reach().step(), dts::v1::REACH_STEP_FINAL);
  EXPECT_EQ(event.reach().number(), 3U);
  EXPECT_EQ(event.reach().p1().scan(), 600U);
  EXPECT_EQ(event.reach().p3().value_mm(), 4.8);
  EXPECT_NEAR(event.reach().d1_mm(), 0.4, 1e-12);
  EXPECT_NEAR(event.reach().d2_mm(), 1.5, 1e-12);
  EXPECT_TRUE(std::isnan(event.reach().smoothness()));
  EXPECT_EQ(event.reach().flags(), static_cast<std::uint32_t>(dts::v1::REACH_FLAG_RESUMED));
}

TEST(EncodeReach, Class_CarriesItsWindow) {
  core::ClassEvent told{.number = 3, .segment = 1, .scan = {900}};
  told.movement = {.trunk_class = core::TrunkClass::Rejected,
                   .probability = {0.1, 0.6, 0.3},
                   .trunk_deg = 30.0,
                   .trunk_lo_deg = 22.0,
                   .trunk_hi_deg = 38.0};

  const dts::v1::Event event = class_event(42, told);

  ASSERT_TRUE(event.has_movement());
  EXPECT_EQ(event.movement().trunk_class(), -1);
  ASSERT_EQ(event.movement().probability_size(), 3);
  EXPECT_EQ(event.movement().probability(1), 0.6);
  EXPECT_EQ(event.movement().trunk_lo_deg(), 22.0);
}

TEST(EncodeReach, TrialWithoutReach_HasNeitherReachNorMovement) {
  const session::TrialResultNotice notice{.session_id = "s", .result = {.trial = 4, .condition = "120", .target_cm = 80.4}};

  const dts::v1::TrialResult result = trial_result(notice);

  EXPECT_EQ(result.trial(), 4U);
  EXPECT_EQ(result.target_cm(), 80.4);
  EXPECT_FALSE(result.has_reach());
  EXPECT_FALSE(result.has_movement());
  EXPECT_EQ(result.expected_class(), -1);
}

TEST(EncodeReach, TrialWithReach_CarriesBoth) {
  session::TrialResultNotice notice{.session_id = "s", .result = {.trial = 4, .attempt = 2, .condition = "120"}};
  notice.result.reach = final_reach();
  notice.result.movement = core::TrunkMovement{.trunk_class = core::TrunkClass::Minor};
  notice.result.expected = core::TrunkClass::Minor;

  const dts::v1::TrialResult result = trial_result(notice);

  EXPECT_EQ(result.attempt(), 2U);
  EXPECT_EQ(result.reach().number(), 3U);
  EXPECT_EQ(result.movement().number(), 3U);
  EXPECT_EQ(result.movement().trunk_class(), 1);
  EXPECT_EQ(result.expected_class(), 1);
}

}  // namespace
}  // namespace dts::ipc
