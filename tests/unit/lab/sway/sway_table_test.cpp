// SPDX-License-Identifier: Apache-2.0
#include "lab/sway/sway_table.h"

#include "lab/base/csv.h"
#include "lab/steadiness/steadiness_rows.h"
#include "lab/sway/measure_file.h"
#include "unit/lab/sway/sway_files.h"

namespace dts::lab::sway {
namespace {

using posturography::Measure;

MeasuredTrial trial(const std::string& file, const Labels& labels) {
  MeasuredTrial one{.file = file};
  one.labels = labels;
  one.analysis = posturography::Analysis{.rate_hz = 100.0, .samples = 3000, .duration_s = 30.0};
  one.analysis->measures.set(Measure::Mvelo, 1.0 / 3.0);
  one.analysis->measures.set(Measure::EllAngle, -84.10922768);
  return one;
}

TEST(SwayTable, Text_IsReadBackDigitForDigit) {
  MeasuredTrial first = trial("with, comma \"and\" quote.csv", {{"eyes", "open"}});
  first.subject = "S01";
  first.trial = 3;
  first.analysis->flags = posturography::sway_flag::kMoved | posturography::sway_flag::kMissingSamples;
  const MeasuredTrial second = trial("b.csv", {{"surface", "foam"}, {"MVELO", "a label called like a measure"}});
  const std::string file = ::testing::TempDir() + "sway_table_" + std::to_string(::getpid()) + ".csv";
  std::ofstream(file) << table_text(std::vector{first, second});

  files::Problems problems;
  const auto rows = steadiness::read_rows(file, "eyes", {}, problems);
  const auto labels = CsvTable::read(file, {{.name = "label_MVELO", .is_text = true}}, problems).texts("label_MVELO");
  std::filesystem::remove(file);

  ASSERT_TRUE(problems.empty()) << files::to_string(problems.front());
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].file, first.file);
  EXPECT_EQ(rows[0].subject, "S01");
  EXPECT_EQ(rows[0].trial, "3");
  EXPECT_EQ(rows[0].label, "open");
  EXPECT_EQ(rows[0].profile, "lp10");
  EXPECT_FALSE(rows[0].is_valid);
  EXPECT_EQ(rows[0].measures, first.analysis->measures);
  EXPECT_TRUE(rows[1].is_valid);
  EXPECT_EQ(rows[1].label, "");
  EXPECT_EQ(rows[1].trial, "");
  EXPECT_EQ(labels[1], "a label called like a measure");
}

TEST(SwayTable, NamesThatASpreadsheetWouldCompute_AreTextThereAndThemselvesHere) {
  MeasuredTrial one = trial("=cmd.csv", {{"@eyes", "+open, wide"}});
  one.subject = "-S01";
  one.condition = "\r=1";
  const std::string text = table_text(std::vector{one});
  const std::string file = ::testing::TempDir() + "sway_formula_" + std::to_string(::getpid()) + ".csv";
  std::ofstream(file) << text;

  files::Problems problems;
  const auto rows = steadiness::read_rows(file, "@eyes", {}, problems);
  std::filesystem::remove(file);

  EXPECT_THAT(text, ::testing::HasSubstr("condition,'@eyes,profile"));
  EXPECT_THAT(text, ::testing::HasSubstr("\n'=cmd.csv,,'-S01,,,\"' =1\",\"'+open, wide\","));
  EXPECT_THAT(text, ::testing::HasSubstr(",-84.10922768,")) << "numbers stay numbers";
  ASSERT_TRUE(problems.empty()) << files::to_string(problems.front());
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].file, "=cmd.csv");
  EXPECT_EQ(rows[0].subject, "-S01");
  EXPECT_EQ(rows[0].label, "+open, wide");
}

TEST(SwayTable, TrialWithoutAnalysis_HasEmptyCells) {
  MeasuredTrial one = trial("a.csv", {});
  one.analysis.reset();

  const std::string text = table_text(std::vector{one});

  const auto header = static_cast<std::ptrdiff_t>(text.find('\n'));
  EXPECT_EQ(std::count(text.begin(), text.begin() + header, ','), std::count(text.begin() + header, text.end(), ','));
  EXPECT_THAT(text, ::testing::Not(::testing::HasSubstr("nan")));
}

TEST(SwayTable, Differences_AreNamed) {
  std::vector<steadiness::SteadinessRow> rows(2);
  for (steadiness::SteadinessRow& row : rows) row = {.profile = "lp10", .rate_hz = 100.0, .duration_s = 30.0};
  EXPECT_TRUE(steadiness::differences_of(rows).empty());

  rows[1] = {.profile = "asis", .rate_hz = 1000.0, .duration_s = 60.0};
  EXPECT_THAT(steadiness::differences_of(rows),
              ::testing::ElementsAre("profiles asis, lp10", "duration from 30 to 60 s", "rate from 100 to 1000 Hz"));
}

TEST(SameAnalysis, DiffersByValueAndPresence) {
  const posturography::Analysis told = *trial("a.csv", {}).analysis;
  EXPECT_TRUE(is_same(told, told));

  posturography::Analysis other = told;
  other.measures.set(Measure::Mvelo, 1.0 / 3.0 + 1e-6);
  EXPECT_FALSE(is_same(told, other));
  other = told;
  other.measures.set(Measure::Rdist, 0.0);
  EXPECT_FALSE(is_same(told, other));
  other = told;
  other.flags = posturography::sway_flag::kMoved;
  EXPECT_FALSE(is_same(told, other));
}

}  // namespace
}  // namespace dts::lab::sway
