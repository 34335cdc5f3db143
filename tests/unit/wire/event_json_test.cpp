// SPDX-License-Identifier: Apache-2.0
#include "dts/wire/event_json.h"

#include <gtest/gtest.h>

#include "dts/wire/options.h"
#include "support/event_text.h"

namespace dts::wire {
namespace {

using test::event_of;

TEST(EventJson, HasTheNamesOfTheProtocol_AndNothingThatIsNotKnown) {
  const v1::Event event = event_of("segment: 1 scan: 1250 reach { step: REACH_STEP_P1 number: 3 p1 { scan: 12 value_mm: 0.5 } twist: 0 }");
  EXPECT_EQ(to_json(event), R"({"segment":1,"scan":"1250","reach":{"step":"REACH_STEP_P1","number":3,"p1":{"scan":"12","value_mm":0.5},)"
                            R"("twist":0}})");
}

TEST(EventJson, ReadsBackToTheLastBit) {
  v1::Event event = event_of("segment: 4294967295 scan: 18446744073709551615 host_time_ns: -5 reach { number: 7 flags: 65535 }");
  v1::Reach& reach = *event.mutable_reach();
  reach.set_d1_mm(1.0 / 3.0);
  reach.set_d2_mm(0.1 + 0.2);
  reach.set_hold_mm(5e-324);
  reach.set_rise_s(1.7976931348623157e308);
  reach.set_smoothness(2.47764715092163e-07);

  const auto read = event_of_json(to_json(event));

  ASSERT_TRUE(read);
  EXPECT_EQ(read->SerializeAsString(), event.SerializeAsString());
}

TEST(EventJson, TextsKeepEveryCharacter_AndLoseBytesThatAreNone) {
  v1::Event event;
  event.mutable_marker()->set_text("eyes \"closed\"\n\t\\ \u00e9\u4e16");
  EXPECT_EQ(event_of_json(to_json(event)).value().marker().text(), event.marker().text());
  event.mutable_marker()->set_text("a\xFF");
  EXPECT_TRUE(event_of_json(to_json(event)));
}

TEST(EventJson, WhatALaterVersionAdds_IsSkipped) {
  const auto read = event_of_json(R"({"scan":"3","later":{"x":[1,{}]},"trial":{"step":"TRIAL_EVENT_KIND_LATER","trial":2,"more":true}})");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->trial().trial(), 2U);
  EXPECT_EQ(read->trial().step(), v1::TRIAL_EVENT_KIND_UNSPECIFIED);
}

TEST(EventJson, WhatIsNoEvent_IsRefused) {
  for (const char* text : {"",
                           "press",
                           "[]",
                           "3",
                           "{}",
                           "null",
                           R"({"foo":1})",
                           R"({"event":"marker","text":"old"})",
                           R"({"marker":{"text":"x"})",
                           R"({"marker":"x"})",
                           R"({"marker":{"text":3}})",
                           R"({"marker":{},"gap":{}})",
                           R"({"segment":-1,"marker":{}})",
                           R"({"segment":4294967296,"marker":{}})",
                           R"({"scan":1.5,"marker":{}})",
                           R"({"scan":"18446744073709551616","marker":{}})",
                           R"({"reach":{"d1_mm":1e999}})",
                           R"({"reach":{"d1_mm":"long"}})",
                           R"({"reach":{"flags":1.5}})",
                           R"({"reach":{"number":-1}})",
                           R"({"class":{"trunk_class":2}})",
                           "{marker:{text:'a'}}",
                           R"({"marker":{"text":"a"},})",
                           "{\"marker\":{\"text\":\"\xFF\"}}"}) {
    EXPECT_FALSE(event_of_json(text)) << text;
  }
}

TEST(EventJson, SameEvent_IsAlwaysTheSameText) {
  const v1::Event event = event_of(
      "trial { trial: 1 labels { key: 'surface' value: 'firm' } labels { key: 'eyes' value: 'open' } labels { key: 'feet' value: 'two' } "
      "}");
  const std::string text = to_json(event);
  EXPECT_NE(text.find(R"("labels":{"eyes":"open","feet":"two","surface":"firm"})"), std::string::npos) << text;
  for (int copy = 0; copy < 100; ++copy) EXPECT_EQ(to_json(*event_of_json(text)), text);
}

TEST(EventJson, TooMuchOfAnything_IsRefusedOrHarmless) {
  EXPECT_TRUE(event_of_json(R"({"marker":{"text":")" + std::string(60'000, 'x') + "\"}}"));
  EXPECT_FALSE(event_of_json(R"({"marker":{"text":")" + std::string(64U << 10U, 'x') + "\"}}"));
  std::string deep;
  for (int level = 0; level < 9000; ++level) deep += "{\"x\":";
  EXPECT_FALSE(event_of_json(deep));
  static_cast<void>(event_of_json(R"({"marker":{},"x":)" + std::string(30'000, '[') + std::string(30'000, ']') + "}"));
}

TEST(EventKinds, AreTheWordsOfTopicsOrOfTheirOwn) {
  EXPECT_EQ(kind_of(event_of("movement {}")), "class");
  EXPECT_EQ(kind_of(event_of("trial_result {}")), "result");
  EXPECT_EQ(kind_of(event_of("segment_start {}")), "segment");
  EXPECT_EQ(kind_of(event_of("loss {}")), "loss");
  EXPECT_EQ(kind_of({}), "");
  EXPECT_TRUE(topic_of(event_of("figure {}")).name().empty()) << "only recorded";
  EXPECT_FALSE(is_event_topic(""));
}

}  // namespace
}  // namespace dts::wire
