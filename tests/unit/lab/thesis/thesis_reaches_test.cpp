// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "lab/study/experiments.h"
#include "lab/thesis/printed.h"
#include "lab/thesis/thesis_parts.h"

namespace dts::lab::thesis {
namespace {

double reach_figure(const Figures& figures, std::string_view name) {
  const auto found = std::ranges::find(figures, name, &Figure::name);
  EXPECT_NE(found, figures.end()) << name;
  return found == figures.end() ? -1.0 : found->value;
}

int sum(const printed::ByTarget& counts) { return std::accumulate(counts.begin(), counts.end(), 0); }

/// The sheet's note: rows of table 6.2 and the totals under it disagree.
TEST(PrintedReachTables, RowsSum_AsTheNoteSays) {
  int nn1 = 0;
  int nn2 = 0;
  for (const auto& row : printed::kHealthy) {
    nn1 += sum(row.nn1);
    nn2 += sum(row.nn2);
  }
  EXPECT_EQ(nn1, 424);
  EXPECT_EQ(nn2, 438);
  EXPECT_NE(nn1, printed::kHealthyTotalNn1);
  EXPECT_NE(nn2, printed::kHealthyTotalNn2);
  int teachers = 0;
  for (const auto& row : printed::kTeachersByNn2) teachers += sum(row);
  EXPECT_EQ(teachers, 134);
  int stroke_nn1 = 0;
  int stroke_nn2 = 0;
  for (const auto& row : printed::kStroke) {
    stroke_nn1 += row.nn1;
    stroke_nn2 += row.nn2;
  }
  EXPECT_EQ(stroke_nn1, 70);
  EXPECT_EQ(stroke_nn2, 71);
}

TEST(ThesisReachTables, TrunkAngles_ComeFromTheTargetAlone) {
  const auto table = thesis_table("6.3");
  ASSERT_TRUE(table) << table.error().what;
  ASSERT_EQ(table->rows.size(), 30U);
  EXPECT_EQ(table->rows[0].label, "H1, 120");
  EXPECT_EQ(reach_figure(table->rows[0].printed, "deg"), 0.4);
  EXPECT_NEAR(reach_figure(table->summary, "bias_150_deg"), -3.5, 0.06);
  EXPECT_NEAR(reach_figure(table->summary, "rms_max_deg"), 6.7, 0.06);
}

TEST(ThesisReachTables, Teachers_AreComputedBesideWhatIsPrinted) {
  RecordProperty("requirement", "CLS-5");
  const auto table = thesis_teachers([](double) {}, 2);
  ASSERT_TRUE(table) << table.error().what;
  ASSERT_EQ(table->rows.size(), 9U);
  EXPECT_EQ(table->rows[1].label, "A, 150");
  EXPECT_EQ(reach_figure(table->rows[1].printed, "correct"), 14.0);
  double ours = 0.0;
  for (const ThesisRow& row : table->rows) ours += reach_figure(row.ours, "correct");
  EXPECT_GE(reach_figure(table->summary, "ours_nn2_four_paces_of_135_median"), 130.0);
  EXPECT_EQ(ours, reach_figure(table->summary, "nn2_correct"));
  EXPECT_EQ(reach_figure(table->summary, "of"), 135.0);
  EXPECT_GE(ours, reach_figure(table->summary, "ours_nn2_four_paces_of_135_least"));
  EXPECT_LE(ours, reach_figure(table->summary, "ours_nn2_four_paces_of_135_most"));
  EXPECT_LT(reach_figure(table->summary, "ours_nn2_one_pace_of_135_most"),
            reach_figure(table->summary, "ours_nn2_four_paces_of_135_least"));
}

TEST(ThesisReachTables, Stroke_HasARowPerPersonAndTellsItsProgress) {
  std::vector<double> told;
  const auto table = thesis_stroke([&](double done) { told.push_back(done); }, 1);
  ASSERT_TRUE(table) << table.error().what;
  ASSERT_EQ(table->rows.size(), 5U);
  EXPECT_EQ(table->rows[0].label, "S1, condition 2");
  EXPECT_EQ(table->rows[1].label, "S2, condition 1");
  EXPECT_GE(reach_figure(table->summary, "ours_nn1_of_75_median"), 60.0);
  EXPECT_EQ(reach_figure(table->summary, "of"), 75.0);
  double nn1 = 0.0;
  for (const ThesisRow& row : table->rows) nn1 += reach_figure(row.ours, "nn1");
  EXPECT_EQ(reach_figure(table->summary, "nn1_correct"), nn1);
  EXPECT_GT(told.size(), 10U);
  EXPECT_TRUE(std::ranges::is_sorted(told));
  EXPECT_LE(told.back(), 1.0);
}

TEST(ThesisReachTables, EveryTable_ShowsTheDrawThatTheStudyShows) {
  constexpr std::size_t kDraws = 3;
  const auto nothing = [](double) {};
  const auto draws = study::run_study({.draws = kDraws, .has_recommended = false}, nothing);
  ASSERT_TRUE(draws);
  const auto shown = static_cast<double>(study::middle_draw(*draws).seed);
  for (const auto& table : {thesis_teachers(nothing, kDraws), thesis_healthy(nothing, kDraws), thesis_stroke(nothing, kDraws)}) {
    ASSERT_TRUE(table);
    EXPECT_EQ(reach_figure(table->summary, "rows_of_seed"), shown) << table->name;
  }
}

}  // namespace
}  // namespace dts::lab::thesis
