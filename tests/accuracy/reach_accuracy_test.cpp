// SPDX-License-Identifier: Apache-2.0
// What the extractor must not fall below on the development set of reaching trials (reach-model section 5, acceptance). The table it
// prints goes by group and condition.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <set>
#include <utility>

#include "accuracy/reach_scores.h"
#include "lab/base/csv.h"
#include "lab/reach/trial_pipeline.h"
#include "lab/reach/volts_file.h"
#include "pipeline/main_reach.h"

namespace dts::accuracy {
namespace {

class ReachAccuracy : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = (std::filesystem::path(DTS_SOURCE_DIR).parent_path() / "shared" / "data" / "reach").string();
    if (!std::filesystem::is_directory(folder_)) GTEST_SKIP() << "no development set at " << folder_;
    set_ = lab::reach::read_trial_set(folder_, problems_);
    ASSERT_TRUE(problems_.empty()) << files::to_string(problems_.front());
    truth_ = read_truth(folder_);
    ASSERT_EQ(truth_.size(), set_.trials.size());
  }
  [[nodiscard]] bool is_stroke(const ReachTruth& truth) const {
    for (const lab::reach::Subject& subject : set_.subjects) {
      if (subject.name == truth.subject) return !subject.is_healthy;
    }
    return false;
  }
  [[nodiscard]] static bool has_trunk(const ReachTruth& truth) { return truth.condition == "150" || truth.condition == "max"; }
  template <class Counts>
  [[nodiscard]] ReachScores score_where(const std::vector<std::optional<core::ReachEvent>>& reaches, Counts counts) const {
    std::vector<bool> is_counted;
    for (const ReachTruth& truth : truth_) is_counted.push_back(counts(truth));
    return score(truth_, reaches, is_counted);
  }
  /// Every reach of a session that bends the trunk by 5 degrees or more has an event of its own, from its start to its end.
  void expect_all_found(const std::string& name) const;

  std::string folder_;
  files::Problems problems_;
  lab::reach::TrialSet set_;
  std::vector<ReachTruth> truth_;
};

TEST_F(ReachAccuracy, DevelopmentSet_MeetsTheAcceptanceLimits) {
  RecordProperty("requirement", "REACH-2");
  const auto reaches = lab::reach::find_reaches(set_, nullptr);

  std::cout << table_head();
  std::set<std::string> conditions;
  for (const ReachTruth& truth : truth_) conditions.insert((is_stroke(truth) ? "stroke " : "healthy ") + truth.condition);
  for (const std::string& name : conditions) {
    const auto scores = score_where(
        reaches, [&](const ReachTruth& truth) { return name == (is_stroke(truth) ? "stroke " : "healthy ") + truth.condition; });
    std::cout << table_row(name, scores);
  }
  const ReachScores fast = score_where(reaches, [](const ReachTruth& truth) { return truth.rate_hz > 100.0; });
  std::cout << table_row("1500 Hz", fast);
  const ReachScores main = score_where(reaches, [&](const ReachTruth& truth) { return !is_stroke(truth) && has_trunk(truth); });
  std::cout << table_row("healthy 150 and max", main);

  EXPECT_GE(static_cast<double>(main.found), 0.99 * static_cast<double>(main.trials));
  EXPECT_GE(main.p1_in_time, 0.85);
  EXPECT_GE(main.p2_in_time, 0.95);
  EXPECT_GE(main.p3_in_time, 0.85);
  EXPECT_GE(main.p3_close, 0.95);
  EXPECT_LE(main.d2_median_error_mm, 0.04);
  EXPECT_EQ(main.gross, 0U);
  EXPECT_LE(main.latest_s, 0.65);
  EXPECT_EQ(fast.found, fast.trials);
  const ReachScores stroke = score_where(reaches, [&](const ReachTruth& truth) { return is_stroke(truth) && truth.trunk_deg >= 12.0; });
  EXPECT_EQ(stroke.found, stroke.trials);
  EXPECT_EQ(stroke.gross, 0U);
}

/// Issue: never a confident wrong answer. A dead sensor is measured around and said; sensors swapped from front to rear are said.
TEST_F(ReachAccuracy, BrokenSensors_AreSaidAndMeasuredAround) {
  RecordProperty("requirement", "REACH-6");
  const auto broken = [&](auto&& damage) {
    lab::reach::TrialSet damaged = set_;
    for (lab::reach::Trial& trial : damaged.trials) std::ranges::for_each(trial.volts, damage);
    return lab::reach::find_reaches(damaged, nullptr);
  };
  for (const std::size_t sensor : {0U, 1U, 2U, 3U}) {
    const auto reaches = broken([sensor](auto& volts) { volts[sensor] = 0.0; });
    const ReachScores main = score_where(reaches, [&](const ReachTruth& truth) { return has_trunk(truth); });
    std::cout << table_row("sensor " + std::to_string(sensor + 1) + " dead", main);
    EXPECT_EQ(main.gross, 0U);
    EXPECT_LE(main.d2_median_error_mm, 0.08);
    for (const auto& reach : reaches) EXPECT_TRUE(!reach || (reach->flags & core::reach_flag::kSubstituted) != 0);
  }
  for (const auto& [one, other] : {std::pair{0U, 2U}, {1U, 3U}, {0U, 3U}, {1U, 2U}}) {
    const auto reaches = broken([one = one, other = other](auto& volts) { std::swap(volts[one], volts[other]); });
    std::size_t confident = 0;
    for (const auto& reach : reaches) {
      constexpr unsigned kSaid = core::reach_flag::kImplausible | core::reach_flag::kMinor | core::reach_flag::kSubstituted;
      if (reach && (reach->flags & kSaid) == 0) ++confident;
    }
    // Crosswise the ratio at rest says little when the curves of the two differ; the mean, and with it d2, stays as it is.
    const std::size_t most = one == 1U && other == 2U ? reaches.size() / 8 : reaches.size() / 50;
    EXPECT_LE(confident, most) << "sensors " << one + 1 << " and " << other + 1 << " swapped";
  }
}

void ReachAccuracy::expect_all_found(const std::string& name) const {
  files::Problems problems;
  const auto volts = lab::reach::VoltsFile::read(folder_ + "/" + name + ".csv", problems);
  ASSERT_NE(volts.find(0), nullptr);
  const auto pipeline = lab::reach::TrialPipeline::create(set_.rig, core::Rate::from_hz(100.0).value());
  ASSERT_TRUE(pipeline);
  const auto events = (*pipeline)->watch(*volts.find(0)).events;
  const lab::CsvTable table = lab::CsvTable::read(folder_ + "/session_events.csv",
                                                  {{.name = "session", .is_text = true},
                                                   {.name = "event", .is_text = true},
                                                   {.name = "trunk_deg", .may_be_empty = true},
                                                   {.name = "t_on"},
                                                   {.name = "t_end", .may_be_empty = true}},
                                                  problems);
  ASSERT_TRUE(problems.empty());
  std::size_t reaches = 0;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    if (table.texts("session")[row] != name || table.texts("event")[row] != "reach" || !(table.numbers("trunk_deg")[row] >= 5.0)) continue;
    ++reaches;
    const double from_s = table.numbers("t_on")[row] - 0.2;
    const double to_s = table.numbers("t_end")[row];
    const bool is_found = std::ranges::any_of(events, [&](const core::ReachEvent& event) {
      const double p1_s = static_cast<double>(event.p1.scan.value) / 100.0;
      const double p3_s = static_cast<double>(event.p3.scan.value) / 100.0;
      return event.step == core::ReachStep::Final && p1_s >= from_s && p3_s <= to_s && (event.flags & core::reach_flag::kMinor) == 0;
    });
    EXPECT_TRUE(is_found) << name << ": the reach from " << table.numbers("t_on")[row] << " s";
  }
  EXPECT_GT(reaches, 4U);
}

TEST_F(ReachAccuracy, Sessions_HaveEveryReachOfFiveDegrees) {
  expect_all_found("A_session");
  expect_all_found("E_session");
}

}  // namespace
}  // namespace dts::accuracy
