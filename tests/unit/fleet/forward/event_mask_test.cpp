// SPDX-License-Identifier: Apache-2.0
// Which texts of an event leave the clinic.
#include "fleet/forward/event_mask.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

#include "dts/wire/event_json.h"
#include "unit/fleet/canary.h"

namespace dts::fleet::forward {
namespace {

/// Fields of events whose text every clinic sends. A new one in this list is a decision on privacy.
const std::set<std::string> kSent{"canary-channel",   "canary-uri",    "canary-session_id", "canary-protocol", "canary-subject",
                                  "canary-condition", "canary-key",    "canary-value",      "canary-profile",  "canary-software",
                                  "canary-problem",   "canary-symbol", "canary-unit",       "canary-name"};

std::string masked(std::string text, const wire::SendRules& rules = {}) {
  mask_event(std::span(text.data(), text.size()), rules);
  return text;
}

/// An event of each kind, with a canary in each text.
std::vector<v1::Event> events_with_canaries() {
  std::vector<v1::Event> events;
  const auto& body = *v1::Event::descriptor()->FindOneofByName("body");
  for (int index = 0; index < body.field_count(); ++index) {
    events.emplace_back();
    fill_with_canaries(events.back(), body.field(index)->name());
  }
  return events;
}

TEST(MaskEvent, RecordedEventOfEachKind_OnlyListedTextsStay) {
  std::set<std::string> found;
  for (const v1::Event& event : events_with_canaries()) found.merge(canaries_in(masked(dts::wire::to_json(event))));
  EXPECT_EQ(found, kSent);
}

TEST(MaskEvent, LiveEventOfEachKind_OnlyListedTextsStay) {
  std::set<std::string> found;
  for (v1::Event event : events_with_canaries()) {
    mask_event(event, {});
    found.merge(canaries_in(event.ShortDebugString()));
  }
  EXPECT_EQ(found, kSent);
}

TEST(MaskEvent, LabelsAllowed_TextOfMarkerAndLabelStay) {
  std::set<std::string> expected = kSent;
  expected.insert({"canary-text", "canary-label"});
  std::set<std::string> recorded;
  std::set<std::string> live;
  for (v1::Event event : events_with_canaries()) {
    recorded.merge(canaries_in(masked(dts::wire::to_json(event), {.labels = true})));
    mask_event(event, {.labels = true});
    live.merge(canaries_in(event.ShortDebugString()));
  }
  EXPECT_EQ(recorded, expected);
  EXPECT_EQ(live, expected);
}

TEST(MaskEvent, RecordedEvent_KeepsItsLengthAndItsNumbers) {
  v1::Event event;
  event.set_segment(3);
  event.set_scan(1250);
  event.mutable_marker()->set_text("Frau \"M\xC3\xBCller\"\n");
  const std::string json = dts::wire::to_json(event);
  const std::string text = masked(json);
  EXPECT_EQ(text.size(), json.size());
  const auto read = dts::wire::event_of_json(text);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->segment(), 3U);
  EXPECT_EQ(read->scan(), 1250U);
  EXPECT_EQ(read->marker().text().find_first_not_of(kMask), std::string::npos);
}

TEST(MaskEvent, EventOfEachKind_IsStillReadWithTheSameNumbers) {
  for (const v1::Event& event : events_with_canaries()) {
    const auto read = dts::wire::event_of_json(masked(dts::wire::to_json(event)));
    ASSERT_TRUE(read) << event.ShortDebugString();
    v1::Event expected = event;
    v1::Event found = *read;
    for (v1::Event* each : {&expected, &found}) {
      mask_event(*each, {});
      if (each->has_marker()) each->mutable_marker()->clear_text();
    }
    EXPECT_EQ(found.SerializeAsString(), expected.SerializeAsString()) << event.ShortDebugString();
  }
}

TEST(MaskEvent, EventOfVersion01_KeepsWordsOfProgramsOnly) {
  EXPECT_EQ(masked(R"({"event":"marker","segment":0,"scan":1250,"text":"eyes closed"})"),
            R"({"event":"marker","segment":0,"scan":1250,"####":"###########"})");
  EXPECT_EQ(masked(R"({"event":"trial","phase":"go","trial":1,"condition":"120","who":"Ann"})"),
            R"({"event":"trial","phase":"go","trial":1,"condition":"120","###":"###"})");
}

TEST(MaskEvent, TextThatIsNoEvent_IsMaskedCompletely) {
  for (const std::string text : {"Frau Weber", "{\"marker\":{\"text\":\"x\"}", "[\"Ann\"]", "\"Ann\"", "{a:'b'}", "{} Ann", ""}) {
    EXPECT_EQ(masked(text), std::string(text.size(), kMask)) << text;
  }
  const std::string deep = std::string(R"({"marker":)") + std::string(40, '[') + "\"Ann\"" + std::string(40, ']') + "}";
  EXPECT_EQ(masked(deep), std::string(deep.size(), kMask));
}

TEST(MaskEvent, TextWhereANumberBelongs_IsMasked) {
  EXPECT_EQ(masked(R"({"scan":"Ann Weber","loss":{"scans":"12"}})"), R"({"scan":"#########","loss":{"scans":"12"}})");
  EXPECT_EQ(masked(R"({"marker":"Ann","loss":["Bob"],"unknown":{"text":"Eve"}})"),
            R"({"marker":"###","loss":["###"],"#######":{"####":"###"}})");
}

}  // namespace
}  // namespace dts::fleet::forward
