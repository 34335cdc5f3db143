// SPDX-License-Identifier: Apache-2.0
#include "record/old_event.h"

#include <gtest/gtest.h>

#include <cmath>

#include <nlohmann/json.hpp>

#include "dts/wire/event_json.h"
#include "support/event_text.h"

namespace dts::record {
namespace {

/// The event in the present form; empty if it is not read.
std::string renewed(const std::string& text) {
  const auto event = old_event_of(text);
  return event ? wire::to_json(*event) : std::string();
}

TEST(OldEvent, OfEveryKind_SaysTheSame) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {R"({"event":"marker","segment":1,"scan":1250,"text":"eyes \"closed\""})",
       R"(segment: 1 scan: 1250 marker { text: "eyes \"closed\"" })"},
      {R"({"event":"segment","segment":0,"scan":7,"host_time_ns":12752754053484})",
       "scan: 7 host_time_ns: 12752754053484 segment_start {}"},
      {R"({"event":"segment","segment":1,"scan":0,"host_time_ns":5,"reason":"ring_full","missing_scans":38,"is_exact":true})",
       "segment: 1 host_time_ns: 5 segment_start { reason: GAP_REASON_RING_FULL missing_scans: 38 is_exact: true }"},
      {R"({"event":"trigger","edge":"falling"})", "trigger { edge: TRIGGER_EDGE_FALLING }"},
      {R"({"event":"session","state":"running","message":"m"})", "session { state: SESSION_STATE_RUNNING message: 'm' }"},
      {R"({"event":"session","state":"aborted","message":"ill"})", "session { is_aborted: true message: 'ill' }"},
      {R"({"event":"device","state":"gone","message":"x"})", "device { state: DEVICE_STATE_GONE message: 'x' }"},
      {R"({"event":"loss","scans":60})", "loss { scans: 60 }"},
      {R"({"event":"figure","name":"a/MVELO","value":1.5,"unit":"mm/s","details":"{\"n\":1}"})",
       R"(figure { name: "a/MVELO" value: 1.5 unit: "mm/s" details: "{\"n\":1}" })"},
      {R"({"event":"trial","phase":"done","trial":3,"attempt":2,"block":1,"condition":"120","eyes":"open","target_cm":85,"rest_s":0.4})",
       "trial { step: TRIAL_EVENT_KIND_DONE trial: 3 attempt: 2 block: 1 condition: '120' labels { key: 'eyes' value: 'open' } target_cm: "
       "85 "
       "rest_s: 0.4 }"},
      {R"({"event":"class","number":4,"class":-1,"p_1":0.5,"p_2":0.25,"p_3":0.25,"trunk_deg":null,"reasons":3})",
       "movement { number: 4 trunk_class: -1 probability: [0.5, 0.25, 0.25] reasons: 3 }"},
      {R"({"event":"reach","step":"final","number":2,"p1_scan":9,"p1_mm":3.5,"p2_scan":10,"p2_mm":2.5,"p3_scan":0,"p3_mm":null,)"
       R"("hold_mm":null,"rise_s":0.36,"flags":1024,"resumed":1})",
       "reach { step: REACH_STEP_FINAL number: 2 p1 { scan: 9 value_mm: 3.5 } p2 { scan: 10 value_mm: 2.5 } d1_mm: 1 rise_s: 0.36 "
       "flags: 1024 resumed: 1 }"},
      {R"({"event":"result","trial":1,"attempt":1,"condition":"80","expected_class":0,"number":4,"flags":8,"class":1,"trunk_deg":0.7,)"
       R"("reasons":16,"is_at_end":true})",
       "trial_result { trial: 1 attempt: 1 condition: '80' expected_class: 0 reach { number: 4 flags: 8 } movement { number: 4 "
       "trunk_class: 1 trunk_deg: 0.7 reasons: 16 } is_at_end: true }"},
      {R"({"event":"sway","trial":1,"attempt":1,"condition":"c","labels":{"eyes":"open"},"first_segment":0,"first_scan":5,"end_segment":1,)"
       R"("end_scan":9,"profile":"lp10","rate_hz":50.0,"samples":215,"duration_s":4.3,"flags":1,"flag_names":"short_record","missing":2,)"
       R"("interpolated":0,"is_valid":true,"software":"dtsd 0.1.0","measures":{"MVELO":{"value":8.25,"unit":"mm/s"}}})",
       "sway { trial: 1 attempt: 1 condition: 'c' labels { key: 'eyes' value: 'open' } first_scan: 5 end_segment: 1 end_scan: 9 profile: "
       "'lp10' rate_hz: 50 samples: 215 duration_s: 4.3 flags: 1 missing: 2 interpolated: 0 is_valid: true software: 'dtsd 0.1.0' "
       "measures { symbol: 'MVELO' value: 8.25 unit: 'mm/s' } }"},
      {R"({"event":"sway","trial":1,"attempt":1,"condition":"c","labels":{},"problem":"too short"})",
       "sway { trial: 1 attempt: 1 condition: 'c' problem: 'too short' }"}};
  for (const auto& [old, expected] : cases) EXPECT_EQ(renewed(old), wire::to_json(test::event_of(expected))) << old;
}

TEST(OldEvent, WhatIsNone_IsRefused) {
  for (const char* text : {"",
                           "press",
                           "[]",
                           "3",
                           "{}",
                           R"({"event":3})",
                           R"({"event":"later","x":1})",
                           R"({"event":"marker","segment":-1})",
                           R"({"event":"marker","segment":4294967296})",
                           R"({"event":"marker","scan":1.5})",
                           R"({"event":"marker","text":7})",
                           R"({"event":"marker")",
                           R"({"event":"loss","scans":-3})",
                           R"({"event":"reach","step":"p1","p2_mm":1,"p2_scan":1.5})",
                           R"({"event":"reach","step":"p1","rise_s":"long"})",
                           R"({"event":"sway","labels":{"eyes":1}})",
                           R"({"event":"sway","labels":[]})",
                           R"({"event":"sway","measures":{"MVELO":{"value":"x","unit":"mm/s"}}})",
                           R"({"event":"sway","measures":{"MVELO":{"unit":"mm/s"}}})",
                           R"({"event":"sway","measures":{"MVELO":{"value":null,"unit":"mm/s"}}})",
                           R"({"event":"figure","name":"x","value":null})",
                           "{\"event\":\"\xFF\"}"}) {
    EXPECT_EQ(renewed(text), "") << text;
  }
}

TEST(OldEvent, AnUnknownWord_IsNotKnown) {
  EXPECT_EQ(old_event_of(R"({"event":"reach","step":"p4"})").value().reach().step(), v1::REACH_STEP_UNSPECIFIED);
  EXPECT_EQ(old_event_of(R"({"event":"trial","phase":3,"trial":1})").value().trial().step(), v1::TRIAL_EVENT_KIND_UNSPECIFIED);
}

TEST(OldEvent, TooMuchOfAnything_IsRefused) {
  nlohmann::json many = {{"event", "marker"}};
  for (int key = 0; key < 63; ++key) many["k" + std::to_string(key)] = key;
  EXPECT_TRUE(old_event_of(many.dump()));
  many["one_more"] = 0;
  EXPECT_FALSE(old_event_of(many.dump()));
  EXPECT_FALSE(old_event_of(R"({"event":"marker","text":")" + std::string(64U << 10U, 'x') + "\"}"));
  EXPECT_FALSE(old_event_of(R"({"event":"marker","deep":)" + std::string(30'000, '[') + std::string(30'000, ']') + "}"));
  EXPECT_TRUE(old_event_of(R"({"event":"marker","text":"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[\"["})")) << "brackets in a text are none";
}

TEST(OldEvent, NegativeZero_IsZeroAsInThePresentForm) {
  const v1::Event event = old_event_of(R"({"event":"reach","step":"p1","twist":-0.0,"p1_scan":4,"p1_mm":-0.0})").value();
  EXPECT_FALSE(std::signbit(event.reach().twist()));
  EXPECT_FALSE(std::signbit(event.reach().p1().value_mm()));
}

TEST(OldCells, AreThoseOfTheRecordedObject) {
  const EventCells cells =
      old_cells_of(R"({"event":"trial","segment":0,"scan":4,"phase":"go","trial":1,"condition":"80","x":null,"y":1.0})");
  EXPECT_EQ(cells.kind, "trial");
  EXPECT_EQ(cells.text, "go");
  EXPECT_EQ(cells.condition, "80");
  EXPECT_EQ(cells.details, R"({"trial":1,"condition":"80","x":null,"y":1.0})");
  EXPECT_EQ(old_cells_of(R"({"event":"marker","text":"a"})").details, "");
}

TEST(EventOfText, ReadsBothForms) {
  EXPECT_EQ(event_of_text(R"({"marker":{"text":"new"}})").value().marker().text(), "new");
  EXPECT_EQ(event_of_text(R"({"event":"marker","text":"old"})").value().marker().text(), "old");
  EXPECT_FALSE(event_of_text("press"));
}

}  // namespace
}  // namespace dts::record
