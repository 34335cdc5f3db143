// SPDX-License-Identifier: Apache-2.0
#include "fleet/worker/kinds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dts::fleet::worker {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string summary_of(const std::string& figures) { return R"({"trials": [], "summary": [)" + figures + "]}"; }

Figures figures(std::string_view kind, const std::string& output, std::uint32_t part = 1) {
  const auto found = figures_of(kind, output, part);
  EXPECT_TRUE(found) << found.error().what;
  return found.value_or(Figures{});
}

TEST(KindsTest, Words_AreThoseOfDtslab) {
  EXPECT_THAT(words_of("sway", "/a b.xdf").value(), ElementsAre("sway", "/a b.xdf", "--json"));
  EXPECT_THAT(words_of("reach", "/a.xdf").value(), ElementsAre("reach", "results", "/a.xdf", "--json"));
  EXPECT_THAT(words_of("replay", "/a.xdf").value(), ElementsAre("replay", "/a.xdf", "--json"));
  EXPECT_FALSE(words_of("thin", "/a.xdf"));
  EXPECT_THAT(kind_names(), ElementsAre("sway", "reach", "replay"));
}

TEST(KindsTest, Summary_HasTheNamesOfTheClinic_AndOfALaterPartItsSuffix) {
  const std::string output = summary_of(R"({"name": "eyes-open/MVELO", "value": 8.25, "unit": "mm/s", "details": {"trials": 2}})");
  const auto first = figures("sway", output).all;
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(first[0].name, "eyes-open/MVELO");
  EXPECT_EQ(first[0].value, 8.25);
  EXPECT_EQ(first[0].unit, "mm/s");
  EXPECT_EQ(first[0].details, R"({"trials":2})");
  EXPECT_EQ(figures("reach", output, 2).all.at(0).name, "eyes-open/MVELO_part_2");
}

TEST(KindsTest, WhatIsNotUsable_IsSkippedAndCounted) {
  const auto found = figures("sway", summary_of(R"(
      {"name": "good", "value": 1, "unit": "1"},
      {"name": "no-number", "value": null, "unit": "1"},
      {"name": "text", "value": "1", "unit": "1"},
      {"name": "no-unit", "value": 1},
      {"name": "", "value": 1, "unit": "1"},
      {"name": 7, "value": 1, "unit": "1"},
      {"name": "line\nend", "value": 1, "unit": "1"},
      {"name": "zero\u0000", "value": 1, "unit": "1"},
      {"name": "good", "value": 2, "unit": "1"},
      {"name": ")" + std::string(201, 'x') + R"(", "value": 1, "unit": "1"},
      7, null, []
  )"));
  ASSERT_EQ(found.all.size(), 1U);
  EXPECT_EQ(found.all[0].value, 1.0);
  EXPECT_EQ(found.skipped, 12U);
}

TEST(KindsTest, DetailsThatADatabaseDoesNotTake_AreLeftOut) {
  const auto found = figures("sway", summary_of(R"({"name": "a", "value": 1, "unit": "1", "details": {"text": "\u0000"}},
      {"name": "b", "value": 1, "unit": "1", "details": "text"},
      {"name": "c", "value": 1, "unit": "1", "details": {"text": ")" +
                                                std::string(5000, 'x') + R"("}})"));
  ASSERT_EQ(found.all.size(), 3U);
  for (const Figure& figure : found.all) EXPECT_EQ(figure.details, "") << figure.name;
}

TEST(KindsTest, MoreFiguresThanAnyAnalysisHas_AreSkipped) {
  std::string list;
  for (int number = 0; number < 10'005; ++number) {
    list += (number == 0 ? "" : ",") + std::string(R"({"name": "n)") + std::to_string(number) + R"(", "value": 1, "unit": "1"})";
  }
  const auto found = figures("sway", summary_of(list));
  EXPECT_EQ(found.all.size(), 10'000U);
  EXPECT_EQ(found.skipped, 5U);
}

TEST(KindsTest, LargestOutput_NeedsNoTimeWithTheSquareOfItsSize) {
  std::string list = "{}";
  while (list.size() < (std::size_t{16} << 20U)) list += ",{}";
  EXPECT_EQ(figures("sway", summary_of(list)).skipped, (list.size() + 1) / 3);  // with that square: hours
}

TEST(KindsTest, BracketsInTexts_AreNoDepth) {
  const std::string name = "a\\\"" + std::string(100, '[');
  const auto found = figures("sway", summary_of("{\"name\": \"" + name + "\", \"value\": 1, \"unit\": \"1\"}")).all;
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].name, "a\"" + std::string(100, '['));
}

TEST(KindsTest, Replay_IsOneOrZero_WithTheFirstDifference) {
  const auto same = figures("replay", R"({"is_identical": true, "streams": [{"stream": "cop"}]})").all;
  ASSERT_EQ(same.size(), 1U);
  EXPECT_EQ(same[0].name, "replay/is_identical");
  EXPECT_EQ(same[0].value, 1.0);
  EXPECT_EQ(same[0].unit, "1");
  EXPECT_EQ(same[0].details, "");
  const auto other = figures("replay", R"({"is_identical": false, "streams": [{"stream": "raw"}, {"stream": "cop",
      "first_difference": {"segment": 1, "scan": 7, "channel": "ml_mm", "recorded": "1.0", "computed": "2.0"}}]})",
                             3)
                         .all;
  ASSERT_EQ(other.size(), 1U);
  EXPECT_EQ(other[0].name, "replay/is_identical_part_3");
  EXPECT_EQ(other[0].value, 0.0);
  EXPECT_THAT(other[0].details, HasSubstr(R"("stream":"cop")"));
  EXPECT_THAT(other[0].details, HasSubstr(R"("scan":7)"));
  EXPECT_TRUE(figures("replay", R"({"streams": []})").all.empty()) << "nothing to compare";
}

TEST(KindsTest, ErrorOfDtslab_IsARejection) {
  const auto found =
      figures("sway", R"({"error": {"code": "not_found", "message": "no stream \"cop\"\u0007", "hint": "use another file"}})");
  ASSERT_TRUE(found.rejection);
  EXPECT_EQ(found.rejection->code, core::ErrorCode::NotFound);
  EXPECT_THAT(found.rejection->what, HasSubstr("no stream \"cop\""));
  EXPECT_THAT(found.rejection->what, Not(HasSubstr("\a")));
  EXPECT_EQ(found.rejection->hint, "use another file");
  EXPECT_EQ(figures("sway", R"({"error": {"code": 7}})").rejection->code, core::ErrorCode::Failed);
}

TEST(KindsTest, TextThatIsNoDocument_Fails) {
  const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']');
  for (const std::string& output :
       {std::string(), std::string("Segmentation fault"), std::string("[]"), std::string("{"), std::string("{}"), deep,
        std::string(R"({"summary": 1})"), std::string(R"({"summary": [{"name": "a", "value": 1e999, "unit": "1"}]})"),
        std::string("{\"summary\": [\"\xff\"]}")}) {
    const auto found = figures_of("sway", output, 1);
    ASSERT_FALSE(found) << output.substr(0, 40);
    EXPECT_EQ(found.error().code, core::ErrorCode::DataDamaged);
  }
  EXPECT_EQ(figures_of("replay", R"({"is_identical": 7})", 1).error().code, core::ErrorCode::DataDamaged);
  EXPECT_EQ(figures_of("thin", "{}", 1).error().code, core::ErrorCode::Unsupported);
}

}  // namespace
}  // namespace dts::fleet::worker
