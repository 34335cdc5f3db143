// SPDX-License-Identifier: Apache-2.0
#include "record/sway_json.h"

#include <gtest/gtest.h>

#include <limits>

namespace dts::record {
namespace {

using posturography::Measure;
using posturography::Measures;

TEST(SwayJson, ValuesReadBackAsTheSameDouble) {
  Measures measures;
  measures.set(Measure::Mvelo, 8.187831842);
  measures.set(Measure::EllAngle, -71.8 / 3.0);
  measures.set(Measure::Totex, std::numeric_limits<double>::denorm_min());
  const auto back = measures_of_json(to_json(measures).text);
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, measures);
  EXPECT_EQ(back->count(), 3U);
}

TEST(SwayJson, AreWrittenWithTheirUnits) {
  Measures measures;
  measures.set(Measure::Mvelo, 2.5);
  EXPECT_EQ(to_json(measures).text, R"({"MVELO":{"value":2.5,"unit":"mm/s"}})");
}

TEST(SwayJson, WhatIsUnknownOrInAnotherUnitIsLeftOut) {
  const auto read =
      measures_of_json(R"({"LATER":{"value":1.0,"unit":"mm"},"MVELO":{"value":1.0,"unit":"cm/s"},"RDIST":{"value":3,"unit":"mm"}})");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->count(), 1U);
  EXPECT_EQ(read->get(Measure::Rdist), 3.0);
}

TEST(SwayJson, RefusesWhatIsNone) {
  for (const char* text : {"", "[]", "7", R"({"MVELO":7})", R"({"MVELO":{"value":"x","unit":"mm/s"}})", R"({"MVELO":{"value":1}})",
                           R"({"MVELO":{"value":1e999,"unit":"mm/s"}})"}) {
    EXPECT_FALSE(measures_of_json(text)) << text;
  }
  for (const char* text : {"", "[]", R"({"eyes":1})", R"({"eyes":["open"]})"}) EXPECT_FALSE(labels_of_json(text)) << text;
}

TEST(SwayJson, LabelsReadBack) {
  const Labels labels{{"eyes", "open"}, {"surface", "\"foam\""}};
  const auto back = labels_of_json(to_json(labels).text);
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, labels);
  for (const std::size_t count : {32U, 33U}) {
    Labels many;
    for (std::size_t i = 0; i < count; ++i) many.emplace_back("label" + std::to_string(i), "x");
    EXPECT_EQ(labels_of_json(to_json(many).text).has_value(), count == 32) << count;
  }
}

TEST(SwayJson, NestedValuesOfEventsStayAsTheyAreWritten) {
  const RecordedEvent event{.event = "sway", .segment = 1, .scan = {2}, .values = {{"measures", JsonText{R"({"A":{"value":1.5}})"}}}};
  const auto back = event_of_json(to_json(event));
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, event);
}

}  // namespace
}  // namespace dts::record
