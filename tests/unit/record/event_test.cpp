// SPDX-License-Identifier: Apache-2.0
#include "record/event.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace dts::record {
namespace {

TEST(RecordedEvent, AllKindsOfValues_ComeBackAsTheyWere) {
  const RecordedEvent event{
      .event = "trial",
      .segment = 4294967295U,
      .scan = {18446744073709551615U},
      .values = {{"phase", std::string("go \"1\"\n")}, {"rest_s", 2.0}, {"trial", std::int64_t{-7}}, {"is_done", true}, {"x", 0.1}}};

  const auto read = event_of_json(to_json(event));

  ASSERT_TRUE(read) << read.error().what;
  EXPECT_EQ(*read, event);
}

TEST(RecordedEvent, Json_IsOneLineInTheDocumentedOrder) {
  const RecordedEvent event{.event = "marker", .segment = 0, .scan = {1250}, .values = {{"text", std::string("eyes\nclosed")}}};
  EXPECT_EQ(to_json(event), R"({"event":"marker","segment":0,"scan":1250,"text":"eyes\nclosed"})");
}

TEST(RecordedEvent, BytesThatAreNoUtf8_AreReplaced) {
  const RecordedEvent event{.event = "marker", .values = {{"text", std::string("a\xFF")}}};
  EXPECT_EQ(text_of(event_of_json(to_json(event)).value(), "text"), "a\uFFFD");
}

TEST(RecordedEvent, UndefinedNumber_StaysUndefined) {
  const auto read = event_of_json(to_json({.event = "x", .values = {{"load_n", std::nan("")}}}));
  ASSERT_TRUE(read);
  EXPECT_TRUE(std::isnan(std::get<double>(read->values.at(0).second)));
}

TEST(RecordedEvent, NestedValues_AreKeptAsJson) {
  const auto read = event_of_json(R"({"event":"x","labels":{"side":"left"},"list":[1,2]})");
  ASSERT_TRUE(read);
  EXPECT_EQ(text_of(*read, "labels"), R"({"side":"left"})");
  EXPECT_EQ(text_of(*read, "list"), "[1,2]");
  EXPECT_EQ(read->segment, 0U);
}

TEST(RecordedEvent, TextOf_ReadsEveryKind) {
  const RecordedEvent event{.event = "x", .values = {{"a", 0.5}, {"b", std::int64_t{3}}, {"c", false}, {"d", std::string("e")}}};
  EXPECT_EQ(text_of(event, "a") + text_of(event, "b") + text_of(event, "c") + text_of(event, "d") + text_of(event, "none"), "0.53falsee");
}

TEST(RecordedEvent, WhatIsNoEvent_IsRefused) {
  for (const char* text :
       {"", "press", "[]", "3", "{}", R"({"event":3})", R"({"event":"x","segment":-1})", R"({"event":"x","segment":4294967296})",
        R"({"event":"x","scan":1.5})", R"({"event":"x","scan":"1"})", R"({"event":"x")", "{\"event\":\"\xFF\"}"}) {
    const auto read = event_of_json(text);
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error().code, core::ErrorCode::DataDamaged);
  }
}

TEST(RecordedEvent, TooMuchOfAnything_IsRefused) {
  nlohmann::json many = {{"event", "x"}};
  for (int key = 0; key < 63; ++key) many["k" + std::to_string(key)] = key;
  EXPECT_TRUE(event_of_json(many.dump()));
  many["one_more"] = 0;
  EXPECT_FALSE(event_of_json(many.dump()));
  EXPECT_FALSE(event_of_json(R"({"event":"x","text":")" + std::string(64U << 10U, 'x') + "\"}"));
  EXPECT_FALSE(event_of_json(R"({"event":"x","deep":)" + std::string(30'000, '[') + std::string(30'000, ']') + "}"));
  EXPECT_TRUE(event_of_json(R"({"event":"x","text":"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[\"["})")) << "brackets in a text are none";
}

}  // namespace
}  // namespace dts::record
