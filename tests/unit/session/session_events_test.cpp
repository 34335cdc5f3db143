// SPDX-License-Identifier: Apache-2.0
// What is published and recorded, as whole messages: every input has a value of its own.
#include "session/session_events.h"

#include <gtest/gtest.h>

#include <limits>

#include <string>
#include <vector>

#include "dts/wire/event_json.h"
#include "events/make.h"
#include "session/rig_session.h"
#include "support/event_text.h"
#include "unit/ipc/message_text.h"

namespace dts::session {
namespace {

using ipc::text;

const std::string kAt = "segment: 1 scan: 900 host_time_ns: 77 ";  // NOLINT(cert-err58-cpp)

core::ReachEvent final_reach() {
  return {.step = core::ReachStep::Final,
          .number = 3,
          .segment = 1,
          .scan = {900},
          .host_time_ns = 77,
          .p1 = {.scan = {600}, .value_mm = 3.5},
          .p2 = {.scan = {650}, .value_mm = 2.75},
          .p3 = {.scan = {800}, .value_mm = 5},
          .features = {.p1_mm = 3.5,
                       .p2_mm = 2.75,
                       .p3_mm = 5,
                       .hold_mm = 1.25,
                       .rise_s = 0.5,
                       .rest_ratio = 0.25,
                       .ratio_change = -0.75,
                       .twist = 0.125,
                       .smoothness = -2},
          .flags = core::reach_flag::kResumed,
          .resumed = 9};
}
const std::string kReach =  // NOLINT(cert-err58-cpp)
    "reach { step: REACH_STEP_FINAL number: 3 p1 { scan: 600 value_mm: 3.5 } p2 { scan: 650 value_mm: 2.75 } p3 { scan: 800 value_mm: 5 } "
    "d1_mm: 0.75 d2_mm: 1.5 hold_mm: 1.25 rise_s: 0.5 rest_ratio: 0.25 ratio_change: -0.75 twist: 0.125 smoothness: -2 flags: 16 resumed: "
    "9 }";

core::TrunkMovement movement() {
  return {.trunk_class = core::TrunkClass::Moderate,
          .probability = {0.125, 0.625, 0.25},
          .trunk_deg = 30,
          .trunk_lo_deg = 22,
          .trunk_hi_deg = 38,
          .reasons = core::class_reason::kCalibrated};
}
const std::string kMovement =  // NOLINT(cert-err58-cpp)
    "movement { number: 3 trunk_class: 2 probability: [0.125, 0.625, 0.25] trunk_deg: 30 trunk_lo_deg: 22 trunk_hi_deg: 38 reasons: 16 }";

SwayTrialResult standing() {
  SwayTrialResult result{.trial = 4,
                         .attempt = 2,
                         .condition = "eyes-open",
                         .labels = {{"feet", "two"}, {"eyes", "open"}},
                         .segment = 1,
                         .first_scan = {100},
                         .end_scan = {2100},
                         .end_segment = 1,
                         .analysis = posturography::Analysis{}};
  result.analysis->rate_hz = 100;
  result.analysis->samples = 2000;
  result.analysis->duration_s = 20;
  result.analysis->flags = posturography::sway_flag::kShortForDiffusion;
  result.analysis->measures.set(posturography::Measure::MveloAp, 5.25);
  return result;
}

TEST(SessionEvents, OfAFrame_SayWhereAndWhat) {
  const core::Frame frame{
      .gap_before = {.reason = core::GapReason::Silence, .missing_scans = 9, .is_exact = true}, .segment = 3, .host_time_ns = 6};
  EXPECT_EQ(text(events::make_gap(frame)), "segment: 3 host_time_ns: 6 gap { reason: GAP_REASON_SILENCE missing_scans: 9 is_exact: true }");
  for (const bool is_rising : {true, false}) {
    EXPECT_EQ(text(events::make(core::TriggerEvent{.segment = 1, .scan = {900}, .host_time_ns = 77, .is_rising = is_rising}, "ch7")),
              kAt + "trigger { edge: TRIGGER_EDGE_" + (is_rising ? "RISING" : "FALLING") + " channel: \"ch7\" }");
  }
  EXPECT_EQ(text(events::make(final_reach(), "")), kAt + kReach);
  const core::ClassEvent moved{.number = 3, .segment = 1, .scan = {900}, .host_time_ns = 77, .movement = movement()};
  EXPECT_EQ(text(events::make(moved, "")), kAt + kMovement);
}

TEST(SessionEvents, SayWhereAndWhat) {
  const TrialEvent go{.kind = TrialEventKind::Go,
                      .trial = 4,
                      .attempt = 2,
                      .block = 3,
                      .condition = "120",
                      .labels = {{"hand", "left"}},
                      .target_cm = 80.5,
                      .rest_s = 12};
  const SessionView running{.id = "s1",
                            .state = SessionState::Running,
                            .request = {.protocol = "reach", .subject = "P7", .label = "before"},
                            .message = "cut\xC3"};
  const ReachTrialResult result{.trial = 4,
                                .attempt = 2,
                                .condition = "120",
                                .target_cm = 80.5,
                                .reach = final_reach(),
                                .movement = movement(),
                                .expected = core::TrunkClass::Maximum};
  const std::vector<std::pair<v1::Event, std::string>> rows{
      {marker_event("cough"), "marker { text: \"cough\" }"},
      {device_event(device::DeviceState::Gone, "usb:x", "plug it in"),
       "device { state: DEVICE_STATE_GONE uri: \"usb:x\" message: \"plug it in\" }"},
      {to_event(running),
       "session { session_id: \"s1\" state: SESSION_STATE_RUNNING protocol: \"reach\" subject: \"P7\" label: \"before\" message: "
       "\"cut\\357\\277\\275\" }"},
      {to_event(go, "s1"),
       "trial { session_id: \"s1\" step: TRIAL_EVENT_KIND_GO trial: 4 attempt: 2 block: 3 condition: \"120\" labels { key: \"hand\" value: "
       "\"left\" } target_cm: 80.5 rest_s: 12 }"},
      {to_event(TrialEvent{}, "s1"), "trial { session_id: \"s1\" step: TRIAL_EVENT_KIND_READY attempt: 1 block: 1 }"},
      {to_event(result, "s1"), "trial_result { session_id: \"s1\" trial: 4 attempt: 2 condition: \"120\" target_cm: 80.5 " + kReach + " " +
                                   kMovement + " expected_class: 3 }"},
      {to_event(ReachTrialResult{.trial = 4, .movement = movement()}, "s1"), "trial_result { session_id: \"s1\" trial: 4 attempt: 1 }"},
      {to_event(ReachTrialResult{.trial = 4, .has_gap = true}, "s1"),
       "trial_result { session_id: \"s1\" trial: 4 attempt: 1 has_gap: true }"},
      {to_event(SessionFigure{.name = "a/MVELO", .value = 2.5, .unit = "mm/s", .details = "{}"}),
       "figure { name: \"a/MVELO\" value: 2.5 unit: \"mm/s\" details: \"{}\" }"},
  };
  for (auto [event, expected] : rows) {
    place(event, {.segment = 1, .scan = {900}, .host_time_ns = 77});
    EXPECT_EQ(text(event), kAt + expected);
    EXPECT_EQ(text(wire::event_of_json(wire::to_json(event)).value()), kAt + expected) << "as it is recorded";
  }
  v1::Event early = marker_event("cough");
  place(early, {});
  EXPECT_FALSE(early.has_host_time_ns()) << "before the first scan";
}

TEST(SessionEvents, Trial_ReadsBack) {
  const TrialEvent written{.kind = TrialEventKind::Rest,
                           .trial = 4,
                           .attempt = 2,
                           .block = 3,
                           .condition = "120",
                           .labels = {{"eyes", "open"}, {"feet", "two"}},
                           .target_cm = 80.5,
                           .rest_s = 12};
  const auto read = trial_of(to_event(written, "s1"));
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, written);
  EXPECT_FALSE(trial_of(test::event_of("trial { trial: 1 }"))) << "without a step";
  EXPECT_FALSE(trial_of(test::event_of("trial { step: 99 }")));
  EXPECT_FALSE(trial_of(test::event_of("trial { step: TRIAL_EVENT_KIND_GO target_cm: nan }"))->target_cm);
  v1::Event many = to_event(written, "s1");
  for (int label = 0; label < 33; ++label) (*many.mutable_trial()->mutable_labels())[std::to_string(label)] = "x";
  EXPECT_FALSE(trial_of(many));
}

TEST(SessionEvents, Sway_ReadsBack) {
  SwayTrialResult loaded = standing();
  loaded.mean_load_n = 627.25;
  EXPECT_EQ(sway_of(to_event(loaded, "s1", "dtsd 1.0")).value().mean_load_n, 627.25);
  loaded.mean_load_n = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(sway_of(to_event(loaded, "s1", "dtsd 1.0")));
  const auto read = sway_of(to_event(standing(), "s1", "dtsd 1.0"));
  ASSERT_TRUE(read);
  EXPECT_EQ(text(to_event(*read, "s1", "dtsd 1.0")), text(to_event(standing(), "s1", "dtsd 1.0")));
  EXPECT_EQ(sway_of(test::event_of("sway { trial: 1 problem: 'a gap' }")).value().problem, "a gap");
  for (const char* bad : {"marker {}", "sway { trial: 1 }", "sway { is_preliminary: true trial: 1 problem: 'x' }"}) {
    EXPECT_FALSE(sway_of(test::event_of(bad))) << bad;
  }
}

TEST(SessionEvents, FinalSway_SaysWhereItIsFrom_AndAProblemHasNoValues) {
  SwayTrialResult result = standing();
  const std::string where =
      "sway { session_id: \"s1\" trial: 4 attempt: 2 condition: \"eyes-open\" labels { key: \"eyes\" value: \"open\" } labels { key: "
      "\"feet\" value: \"two\" } first_scan: 100 end_scan: 2100 ";
  EXPECT_EQ(text(to_event(result, "s1", "dtsd 1.0")),
            where +
                "profile: \"lp10\" rate_hz: 100 samples: 2000 duration_s: 20 flags: 4 is_valid: true software: \"dtsd 1.0\" measures { "
                "symbol: \"MVELO_AP\" value: 5.25 unit: \"mm/s\" } first_segment: 1 end_segment: 1 missing: 0 interpolated: 0 }");
  result.analysis.reset();
  result.problem = "a gap";
  EXPECT_EQ(text(to_event(result, "s1", "")), where + "problem: \"a gap\" first_segment: 1 end_segment: 1 }");
}

}  // namespace
}  // namespace dts::session
