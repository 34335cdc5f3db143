// SPDX-License-Identifier: Apache-2.0
// What leaves on the bus, as whole messages: every input has a value of its own.
#include "ipc/encode.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "ipc/encode_reach.h"
#include "ipc/encode_sway.h"
#include "unit/ipc/message_text.h"

namespace dts::ipc {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const std::string kAt = "instance_id: 42 segment: 1 scan: 900 host_time_ns: 77 ";  // NOLINT(cert-err58-cpp)

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

session::SwayTrialResult standing() {
  session::SwayTrialResult result{.trial = 4,
                                  .attempt = 2,
                                  .condition = "eyes-open",
                                  .labels = {{"feet", "two"}, {"eyes", "open"}},
                                  .segment = 1,
                                  .first_scan = {100},
                                  .end_scan = {2100},
                                  .analysis = posturography::Analysis{}};
  result.analysis->rate_hz = 100;
  result.analysis->samples = 2000;
  result.analysis->duration_s = 20;
  result.analysis->flags = posturography::sway_flag::kShortForDiffusion;
  result.analysis->measures.set(posturography::Measure::MveloAp, 5.25);
  return result;
}

TEST(StreamEncoder, Block_ArrivesColumnByColumnWithItsPosition_AndWithoutAnythingOfALongerOneBefore) {
  StreamEncoder encoder(42, "floor",
                        {.name = "cop", .rate = core::Rate::create(3000, 2).value(), .channels = {{"ml_mm", "mm"}, {"ap_mm", "mm"}}});
  core::Block block(2, 8);
  block.set_count(8);
  static_cast<void>(encoder.encode(block, 0, 0));
  block.set_count(3);
  block.segment = 2;
  block.first_scan = {1000};
  block.host_time_ns = 5;
  block.host_time_uncertainty_ns = 17;
  block.sequence = 7;
  for (std::size_t scan = 0; scan < 3; ++scan) {
    block.column(0)[scan] = 0.5 + static_cast<double>(scan);
    block.column(1)[scan] = scan == 2 ? kNan : 10.0 + static_cast<double>(scan);
  }
  block.quality(1)[0] = core::quality::kStuck;
  block.quality(1)[2] = core::quality::kRail;

  EXPECT_EQ(encoder.topic(), "floor/cop");
  EXPECT_EQ(text(encoder.encode(block, 11, 13)),
            "instance_id: 42 segment: 2 first_scan: 1000 scan_count: 3 channel_count: 2 rate { numerator: 1500 denominator: 1 } "
            "host_time_ns: 5 sequence: 7 lost_scans_total: 11 dropped_blocks_total: 13 values: [0.5, 1.5, 2.5, 10, 11, nan] "
            "quality: \"\\000\\003\" host_time_uncertainty_ns: 17");
}

TEST(Events, OfAFrame_SayWhereAndWhat) {
  const core::Frame frame{
      .gap_before = {.reason = core::GapReason::Silence, .missing_scans = 9, .is_exact = true}, .segment = 3, .host_time_ns = 6};
  EXPECT_EQ(text(gap_event(42, frame)),
            "instance_id: 42 segment: 3 host_time_ns: 6 gap { reason: GAP_REASON_SILENCE missing_scans: 9 is_exact: true }");
  for (const bool is_rising : {true, false}) {
    EXPECT_EQ(text(event_message(42, core::TriggerEvent{.segment = 1, .scan = {900}, .host_time_ns = 77, .is_rising = is_rising}, "ch7")),
              kAt + "trigger { edge: TRIGGER_EDGE_" + (is_rising ? "RISING" : "FALLING") + " channel: \"ch7\" }");
  }
  EXPECT_EQ(text(event_message(42, final_reach(), "")), kAt + kReach);
  const core::ClassEvent moved{.number = 3, .segment = 1, .scan = {900}, .host_time_ns = 77, .movement = movement()};
  EXPECT_EQ(text(event_message(42, moved, "")), kAt + kMovement);
}

TEST(Events, OfWhatTheSupervisorNoticed_HaveTheirTopicAndSayWhereAndWhat) {
  const session::TrialEvent go{.kind = session::TrialEventKind::Go,
                               .trial = 4,
                               .attempt = 2,
                               .block = 3,
                               .condition = "120",
                               .labels = {{"hand", "left"}},
                               .target_cm = 80.5,
                               .rest_s = 12};
  const session::SessionView running{.id = "s1",
                                     .state = session::SessionState::Running,
                                     .request = {.protocol = "reach", .subject = "P7", .label = "before"},
                                     .message = "why"};
  const struct {
    std::variant<session::MarkerNotice, session::DeviceNotice, session::SessionView, session::TrialNotice, session::TrialResultNotice,
                 session::SwayNotice>
        body;
    std::string expected;
  } rows[]{
      {session::MarkerNotice{"cough"}, "marker { text: \"cough\" }"},
      {session::DeviceNotice{device::DeviceState::Gone, "usb:x", "plug it in"},
       "device { state: DEVICE_STATE_GONE uri: \"usb:x\" message: \"plug it in\" }"},
      {running,
       "session { session_id: \"s1\" state: SESSION_STATE_RUNNING protocol: \"reach\" subject: \"P7\" label: \"before\" message: \"why\" "
       "}"},
      {session::TrialNotice{"s1", go},
       "trial { session_id: \"s1\" kind: TRIAL_EVENT_KIND_GO trial: 4 attempt: 2 block: 3 condition: \"120\" labels { key: \"hand\" value: "
       "\"left\" } "
       "target_cm: 80.5 rest_s: 12 }"},
      {session::TrialResultNotice{"s1",
                                  {.trial = 4,
                                   .attempt = 2,
                                   .condition = "120",
                                   .target_cm = 80.5,
                                   .reach = final_reach(),
                                   .movement = movement(),
                                   .expected = core::TrunkClass::Maximum}},
       "trial_result { session_id: \"s1\" trial: 4 attempt: 2 condition: \"120\" target_cm: 80.5 " + kReach + " " + kMovement +
           " expected_class: 3 }"},
      {session::TrialResultNotice{"s1", {.trial = 4, .movement = movement()}},
       "trial_result { session_id: \"s1\" trial: 4 attempt: 1 expected_class: -1 }"},
      {session::SwayNotice{"s1", "dtsd 1.0", standing()}, "sway { " + text(sway(standing(), "s1", "dtsd 1.0")) + " }"},
  };
  for (const auto& row : rows) {
    const dts::v1::Event event =
        notice_event(42, {.rig = "floor", .at = {.segment = 1, .scan = {900}, .host_time_ns = 77}, .body = row.body});
    EXPECT_EQ(text(event), kAt + row.expected);
  }
}

TEST(EncodeSway, RunningValues_ArePreliminaryAndComplete) {
  core::SwayEvent event{.segment = 1, .scan = {900}, .host_time_ns = 77, .first_scan = {100}, .trial = 3};
  event.values = {.samples = 5,
                  .rate_hz = 0.5,
                  .rdist_mm = 1,
                  .rdist_ap_mm = 2,
                  .rdist_ml_mm = 3,
                  .totex_mm = 40,
                  .totex_ap_mm = 50,
                  .totex_ml_mm = 60,
                  .range_ap_mm = 7,
                  .range_ml_mm = 8,
                  .ellipse_sd1_mm = 9,
                  .ellipse_sd2_mm = 10,
                  .ellipse_angle_deg = -11,
                  .pea95_f_mm2 = 12};
  const auto measured = [&](std::uint64_t samples) {
    event.values.samples = samples;
    std::string all;
    const dts::v1::Event out = event_message(42, event, "");
    for (const dts::v1::SwayMeasure& measure : out.sway().measures()) all += text(measure).substr(8) + "; ";
    return all;
  };
  const std::string two =
      "\"RDIST\" value: 1 unit: \"mm\"; \"RDIST_AP\" value: 2 unit: \"mm\"; \"RDIST_ML\" value: 3 unit: \"mm\"; \"TOTEX\" value: 40 unit: "
      "\"mm\"; "
      "\"TOTEX_AP\" value: 50 unit: \"mm\"; \"TOTEX_ML\" value: 60 unit: \"mm\"; \"MVELO\" value: 10 unit: \"mm/s\"; "
      "\"MVELO_AP\" value: 12.5 unit: \"mm/s\"; \"MVELO_ML\" value: 15 unit: \"mm/s\"; \"RANGE_AP\" value: 7 unit: \"mm\"; "
      "\"RANGE_ML\" value: 8 unit: \"mm\"; ";
  EXPECT_EQ(measured(1), "");
  EXPECT_EQ(measured(2), two);
  event.values.rate_hz = 0.75;
  EXPECT_EQ(measured(3), two +
                             "\"PEA95_F\" value: 12 unit: \"mm2\"; \"ELL_SD1\" value: 9 unit: \"mm\"; \"ELL_SD2\" value: 10 unit: \"mm\"; "
                             "\"ELL_ANGLE\" value: -11 unit: \"deg\"; ");
  event.values.rdist_mm = kNan;
  EXPECT_EQ(measured(2).substr(0, 10), "\"RDIST_AP\"") << "what is not defined is not listed";
  event.values = {.samples = 1, .rate_hz = 0.5};
  EXPECT_EQ(text(event_message(42, event, "")),
            kAt +
                "sway { is_preliminary: true trial: 3 first_scan: 100 end_scan: 901 profile: \"lp10\" rate_hz: 0.5 "
                "samples: 1 duration_s: 2 is_valid: true }");
}

TEST(EncodeSway, FinalValues_SayWhereTheyAreFrom_AndAProblemHasNone) {
  session::SwayTrialResult result = standing();
  const std::string where =
      "session_id: \"s1\" trial: 4 attempt: 2 condition: \"eyes-open\" labels { key: \"eyes\" value: \"open\" } labels { key: \"feet\" "
      "value: \"two\" } "
      "first_scan: 100 end_scan: 2100 ";
  EXPECT_EQ(text(sway(result, "s1", "dtsd 1.0")),
            where +
                "profile: \"lp10\" rate_hz: 100 samples: 2000 duration_s: 20 flags: 4 is_valid: true "
                "software: \"dtsd 1.0\" measures { symbol: \"MVELO_AP\" value: 5.25 unit: \"mm/s\" }");
  result.analysis.reset();
  result.problem = "a gap";
  EXPECT_EQ(text(sway(result, "s1", "")), where + "problem: \"a gap\"");
}

}  // namespace
}  // namespace dts::ipc
