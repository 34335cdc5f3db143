// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "dts/wire/event_json.h"
#include "events/make.h"
#include "events/read.h"
#include "support/event_text.h"

namespace dts::events {
namespace {

using posturography::Measure;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

core::ReachEvent final_reach() {
  core::ReachEvent event{.step = core::ReachStep::Final, .number = 7, .segment = 2, .scan = {123'456'789'012}, .host_time_ns = 5};
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
v1::Event through_json(const core::Event& event) { return wire::event_of_json(wire::to_json(make(event, "trigger"))).value(); }

std::string refusal_of(const std::string& text) {
  const v1::Event event = test::event_of(text);
  if (event.has_reach()) {
    const auto read = reach_of(event);
    return read ? "accepted" : read.error().what;
  }
  const auto read = class_of(event);
  return read ? "accepted" : read.error().what;
}

TEST(Events, FinalReach_ComesBackToTheLastBit) {
  const core::ReachEvent written = final_reach();
  const auto read = reach_of(through_json(written));

  ASSERT_TRUE(read);
  EXPECT_EQ(read->step, written.step);
  EXPECT_EQ(read->number, written.number);
  EXPECT_EQ(read->segment, written.segment);
  EXPECT_EQ(read->scan, written.scan);
  EXPECT_EQ(read->host_time_ns, written.host_time_ns);
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

TEST(Events, ProvisionalReach_LacksWhatIsNotKnown) {
  const core::ReachEvent written{.step = core::ReachStep::P1, .number = 1, .p1 = {.scan = {10}, .value_mm = 3.0}};
  const v1::Event event = make(written, "");
  EXPECT_TRUE(event.reach().has_p1());
  EXPECT_FALSE(event.reach().has_p2() || event.reach().has_d1_mm() || event.reach().has_smoothness());

  const auto read = reach_of(through_json(written));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->p1.value_mm, 3.0);
  EXPECT_TRUE(std::isnan(read->p3.value_mm));
  EXPECT_TRUE(std::isnan(read->features.smoothness));
}

TEST(Events, NegativeZero_IsWrittenAsItIsReadBack) {
  core::ReachEvent written = final_reach();
  written.features.twist = -0.0;
  const v1::Event event = make(written, "");
  EXPECT_FALSE(std::signbit(event.reach().twist()));
}

TEST(Events, DamagedReachOrClass_IsRefusedWithItsField) {
  EXPECT_NE(refusal_of("reach { number: 1 }").find("\"step\""), std::string::npos);
  EXPECT_NE(refusal_of("reach { step: REACH_STEP_P1 flags: 65536 }").find("\"flags\""), std::string::npos);
  EXPECT_NE(refusal_of("reach { step: REACH_STEP_P1 resumed: 65536 }").find("\"resumed\""), std::string::npos);
  EXPECT_NE(refusal_of("movement { trunk_class: 4 probability: [0, 0, 1] }").find("\"trunk_class\""), std::string::npos);
  EXPECT_NE(refusal_of("movement { trunk_class: 2 probability: [0, 1] }").find("\"probability\""), std::string::npos);
  EXPECT_NE(refusal_of("movement { trunk_class: 2 probability: [0, 1, 0] reasons: 65536 }").find("\"reasons\""), std::string::npos);
  EXPECT_NE(refusal_of("marker {}").find("event \"marker\" at segment 0, scan 0"), std::string::npos);
}

TEST(Events, NumbersThatAreNotFinite_AreNotKnown) {
  const auto read = reach_of(test::event_of("reach { step: REACH_STEP_P1 p1 { scan: 3 value_mm: nan } rise_s: inf }"));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->p1.scan.value, 0U);
  EXPECT_TRUE(std::isnan(read->features.rise_s));
}

TEST(Events, Class_ComesBackToTheLastBit) {
  const core::ClassEvent written{.number = 4,
                                 .segment = 1,
                                 .scan = {99},
                                 .movement = {.trunk_class = core::TrunkClass::Rejected,
                                              .probability = {0.1, 0.2, 0.7},
                                              .trunk_deg = 25.0,
                                              .trunk_lo_deg = 1.0 / 7.0,
                                              .trunk_hi_deg = std::numeric_limits<double>::quiet_NaN(),
                                              .reasons = core::class_reason::kUnsure}};
  const auto read = class_of(through_json(written));

  ASSERT_TRUE(read);
  EXPECT_EQ(read->number, 4U);
  EXPECT_EQ(read->movement.trunk_class, core::TrunkClass::Rejected);
  EXPECT_EQ(read->movement.probability, written.movement.probability);
  EXPECT_EQ(read->movement.trunk_deg, 25.0);
  EXPECT_EQ(read->movement.trunk_lo_deg, 1.0 / 7.0);
  EXPECT_TRUE(std::isnan(read->movement.trunk_hi_deg));
  EXPECT_EQ(read->movement.reasons, core::class_reason::kUnsure);
}

TEST(Events, Trigger_HasItsEdgeAndChannel) {
  const v1::Event event = through_json(core::TriggerEvent{.segment = 3, .scan = {8}, .host_time_ns = 9, .is_rising = false});
  EXPECT_EQ(event.trigger().edge(), v1::TRIGGER_EDGE_FALLING);
  EXPECT_EQ(event.trigger().channel(), "trigger");
  EXPECT_EQ(event.host_time_ns(), 9);
}

TEST(Events, PreliminarySway_HasTheMeasuresThatAreExact) {
  RecordProperty("requirement", "SWAY-8");
  core::SwayEvent sway{.segment = 2, .scan = {899}, .host_time_ns = 5, .first_scan = {300}, .trial = 4};
  sway.values = {.samples = 200,
                 .rate_hz = 100.0,
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
  const auto measures_of = [&sway] {
    std::ostringstream text;
    const v1::Event made = make(sway, "");
    for (const v1::SwayMeasure& measure : made.sway().measures()) {
      text << measure.symbol() << ' ' << measure.value() << ' ' << measure.unit() << '\n';
    }
    return text.str();
  };
  const std::string of_two = "RDIST 1 mm\nRDIST_AP 2 mm\nRDIST_ML 3 mm\nTOTEX 40 mm\nTOTEX_AP 50 mm\nTOTEX_ML 60 mm\n";
  const std::string ranges = "RANGE_AP 7 mm\nRANGE_ML 8 mm\n";
  const std::string of_plane = "PEA95_F 12 mm2\nELL_SD1 9 mm\nELL_SD2 10 mm\nELL_ANGLE -11 deg\n";
  EXPECT_EQ(measures_of(), of_two + "MVELO 20 mm/s\nMVELO_AP 25 mm/s\nMVELO_ML 30 mm/s\n" + ranges + of_plane);
  v1::Event event = make(sway, "");
  event.mutable_sway()->clear_measures();
  EXPECT_EQ(event.ShortDebugString(),
            test::event_of("segment: 2 scan: 899 host_time_ns: 5 sway { is_preliminary: true trial: 4 first_segment: 2 first_scan: 300 "
                           "end_segment: 2 end_scan: 900 profile: 'lp10' samples: 200 rate_hz: 100 duration_s: 2 flags: 0 is_valid: true "
                           "window: SWAY_WINDOW_TRIAL }")
                .ShortDebugString());

  sway.trial = 0;
  EXPECT_EQ(make(sway, "").sway().window(), v1::SWAY_WINDOW_LATEST);
  EXPECT_EQ(make(sway, "").sway().window_s(), core::kRecentSwayS);
  sway.values.range_ml_mm = kUndefined;
  sway.values.samples = 3;
  EXPECT_THAT(measures_of(), AllOf(HasSubstr("ELL_SD2"), Not(HasSubstr("RANGE_ML"))));
  sway.values.samples = 2;
  EXPECT_THAT(measures_of(), AllOf(HasSubstr("MVELO 2000 mm/s"), Not(HasSubstr("PEA95_F"))));
  sway.values.samples = 1;
  EXPECT_EQ(measures_of(), "");
}

TEST(Events, Gap_SaysWhatIsMissing) {
  core::Frame frame;
  frame.segment = 3;
  frame.host_time_ns = 7;
  frame.gap_before = {.reason = core::GapReason::Stall, .missing_scans = 12, .is_exact = true};
  EXPECT_EQ(
      make_gap(frame).ShortDebugString(),
      test::event_of("segment: 3 host_time_ns: 7 gap { reason: GAP_REASON_STALL missing_scans: 12 is_exact: true }").ShortDebugString());
}

TEST(Events, Analysis_ComesBackToTheLastBit) {
  posturography::Analysis written{.profile = posturography::Profile::AsIs,
                                  .rate_hz = 100.0,
                                  .samples = 2000,
                                  .duration_s = 20.0,
                                  .flags = 3,
                                  .missing = 4,
                                  .interpolated = 5};
  written.measures.set(Measure::Mvelo, 8.187831842);
  written.measures.set(Measure::EllAngle, -71.8 / 3.0);
  written.measures.set(Measure::Totex, std::numeric_limits<double>::denorm_min());
  v1::Event event;
  add(written, *event.mutable_sway());

  const auto read = analysis_of(wire::event_of_json(wire::to_json(event)).value().sway());

  ASSERT_TRUE(read);
  EXPECT_EQ(read->profile, posturography::Profile::AsIs);
  EXPECT_EQ(read->measures, written.measures);
  EXPECT_EQ(read->samples, 2000U);
  EXPECT_EQ(read->flags, 3U);
  EXPECT_EQ(read->missing + read->interpolated, 9U);
}

TEST(Events, MeasuresThatAreUnknownOrInAnotherUnit_AreSkipped) {
  const std::string good = "sway { profile: 'lp10' rate_hz: 100 samples: 1 duration_s: 1 flags: 0 ";
  const auto read = analysis_of(test::event_of(good + "measures { symbol: 'LATER' value: 1 unit: 'mm' }"
                                                      "measures { symbol: 'MVELO' value: 1 unit: 'cm/s' }"
                                                      "measures { symbol: 'RDIST' value: 3 unit: 'mm' } }")
                                    .sway());
  ASSERT_TRUE(read);
  EXPECT_EQ(read->measures.count(), 1U);
  EXPECT_EQ(read->measures.get(Measure::Rdist), 3.0);
  for (const char* bad :
       {"sway {}", "sway { profile: 'x' rate_hz: 100 samples: 1 duration_s: 1 flags: 0 }",
        "sway { profile: 'lp10' rate_hz: nan samples: 1 duration_s: 1 flags: 0 }",
        "sway { profile: 'lp10' samples: 1 duration_s: 1 flags: 0 }", "sway { profile: 'lp10' rate_hz: 100 duration_s: 1 flags: 0 }",
        "sway { profile: 'lp10' rate_hz: 100 samples: 1 flags: 0 }", "sway { profile: 'lp10' rate_hz: 100 samples: 1 duration_s: 1 }"}) {
    EXPECT_FALSE(analysis_of(test::event_of(bad).sway())) << bad;
  }
  EXPECT_FALSE(analysis_of(test::event_of(good + "measures { symbol: 'RDIST' value: inf unit: 'mm' } }").sway()));
}

}  // namespace
}  // namespace dts::events
