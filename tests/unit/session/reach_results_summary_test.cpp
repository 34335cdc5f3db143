// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "reach_results_events.h"
#include "session/json_object.h"
#include "session/reach_results.h"
#include "session/reach_summary.h"

namespace dts::session {
namespace {

using core::TrunkClass;
using made::tell_trial;

const SessionFigure* find(const std::vector<SessionFigure>& figures, const std::string& name) {
  for (const SessionFigure& figure : figures) {
    if (figure.name == name) return &figure;
  }
  return nullptr;
}
double value_of(const std::vector<SessionFigure>& figures, const std::string& name) {
  const SessionFigure* figure = find(figures, name);
  return figure == nullptr ? std::numeric_limits<double>::quiet_NaN() : figure->value;
}

/// Two trials to each of 100, 120 and 150 %, and what was seen.
ReachResults session() {
  ReachResults results(made::volunteer(), nullptr);
  tell_trial(results, 1, 1000, "100", 67.0, 0.1, TrunkClass::None, 1.0);
  tell_trial(results, 2, 2000, "120", 80.4, 0.2, TrunkClass::Minor, 4.0);
  tell_trial(results, 3, 3000, "150", 100.5, 0.8, TrunkClass::Moderate, 24.0);
  tell_trial(results, 4, 4000, "100", 67.0, 0.3, TrunkClass::Minor, 3.0);
  tell_trial(results, 5, 5000, "120", 80.4, 0.4, TrunkClass::Rejected, 8.0);
  tell_trial(results, 6, 6000, "150", 100.5, 1.0, TrunkClass::Moderate, 28.0);
  return results;
}

TEST(ReachSummary, Shares_CountRejectedApart) {
  const auto figures = session().summary();
  EXPECT_EQ(value_of(figures, "trials"), 6.0);
  EXPECT_EQ(value_of(figures, "reaches_detected_share"), 1.0);
  EXPECT_DOUBLE_EQ(value_of(figures, "rejected_share"), 1.0 / 6.0);
  EXPECT_DOUBLE_EQ(value_of(figures, "class_agreement_share"), 4.0 / 5.0);
  EXPECT_EQ(find(figures, "class_agreement_share")->details, R"({"agreed":4,"compared":5})");
}

TEST(ReachSummary, CriticalBoundary_IsTheTargetNearestToTheFingertips) {
  const auto figures = session().summary();
  EXPECT_DOUBLE_EQ(value_of(figures, "trunk_at_critical_boundary_deg"), 6.0);  // of the two at 120 %, one unsure
  EXPECT_THAT(find(figures, "trunk_at_critical_boundary_deg")->details, testing::HasSubstr(R"("condition":"120")"));
}

TEST(ReachSummary, CriticalBoundaryOfAShortReach_IsTheNearestWithinIt) {
  ReachResults results(physics::Person{50.0, 160.0, 68.0, 43.0}, nullptr);  // S1 of thesis Table 6.1
  tell_trial(results, 1, 1000, "50", 34.0, 0.5, TrunkClass::Minor, 14.0);
  tell_trial(results, 2, 2000, "63", 43.0, 0.8, TrunkClass::Moderate, 21.0);
  EXPECT_DOUBLE_EQ(value_of(results.summary(), "trunk_at_critical_boundary_deg"), 21.0);
}

TEST(ReachSummary, OnlyFarTargets_HaveNoCriticalBoundary) {
  ReachResults results(made::volunteer(), nullptr);
  tell_trial(results, 1, 1000, "150", 100.5, 0.8, TrunkClass::Moderate, 24.0);
  EXPECT_EQ(find(results.summary(), "trunk_at_critical_boundary_deg"), nullptr);
}

TEST(ReachSummary, AnglesOfDoubtfulReaches_DoNotCount) {
  ReachResults results(made::volunteer(), nullptr);
  tell_trial(results, 1, 1000, "120", 80.4, 0.2, TrunkClass::Minor, 4.0);
  const core::ReachEvent event = made::reach(2, 2050);
  core::ClassEvent doubtful = made::classed(event, TrunkClass::Rejected, 70.0);
  doubtful.movement.reasons = core::class_reason::kOutOfRange;
  results.take(made::step(TrialEventKind::Go, 2, 1, "120", 80.4), 0, {2000});
  results.take(event);
  results.take(doubtful);
  results.take(made::step(TrialEventKind::Done, 2, 1, "120", 80.4), 0, {2500});
  results.finish();
  EXPECT_DOUBLE_EQ(value_of(results.summary(), "trunk_at_critical_boundary_deg"), 4.0);
}

TEST(ReachSummary, Consistency_IsWithinTargetsNotBetweenThem) {
  const auto figures = session().summary();
  EXPECT_NEAR(value_of(figures, "d2_sd_mm"), std::sqrt(0.02), 1e-12);  // 0.1414 at each of the three
  EXPECT_NEAR(value_of(figures, "trunk_sd_deg"), std::sqrt((2.0 + 8.0 + 8.0) / 3.0), 1e-12);
  EXPECT_DOUBLE_EQ(value_of(figures, "sparc_mean"), -1.6);
}

TEST(ReachSummary, Targets_SayEverythingPerTarget) {
  const auto figures = session().summary();
  EXPECT_EQ(value_of(figures, "targets"), 3.0);
  const std::string& details = find(figures, "targets")->details;
  EXPECT_THAT(details,
              testing::HasSubstr(R"({"condition":"120","target_cm":80.4,"expected_class":1,"trials":2,"with_gap":0,"reaches_detected":2,)"
                                 R"("classes":{"none":0,"minor":1,"moderate":0,"maximum":0,"rejected":1},"agreed":1,"compared":1,)"
                                 R"("d2_mean_mm":0.3)"));
  EXPECT_THAT(details, testing::ContainsRegex(R"("d2_sd_mm":0\.1414[0-9]*,"trunk_mean_deg":6,"trunk_sd_deg":2\.828[0-9]*,)"
                                              R"("sparc_mean":-1\.6,"sparc_sd":0})"));
  EXPECT_THAT(details, testing::StartsWith(R"({"targets":[{"condition":"100",)"));
}

TEST(ReachSummary, TargetWithinReachWithoutAReach_Agrees) {
  ReachResults results(made::volunteer(), nullptr);
  results.take(made::step(TrialEventKind::Go, 1, 1, "80", 53.6), 0, {1000});
  results.take(made::step(TrialEventKind::Done, 1, 1, "80", 53.6), 0, {1500});
  results.take(made::step(TrialEventKind::Go, 2, 1, "150", 100.5), 0, {2000});
  results.take(made::step(TrialEventKind::Done, 2, 1, "150", 100.5), 0, {2500});
  results.finish();
  const auto figures = results.summary();
  EXPECT_EQ(value_of(figures, "reaches_detected_share"), 0.0);
  EXPECT_EQ(find(figures, "class_agreement_share")->details, R"({"agreed":1,"compared":1})");
}

TEST(ReachSummary, GapsAndUnknownFigures_LeaveNothingUndefined) {
  ReachResults results(std::nullopt, nullptr);
  core::ReachEvent event = made::reach(1, 1050);
  event.features.smoothness = std::numeric_limits<double>::quiet_NaN();
  results.take(made::step(TrialEventKind::Go, 1), 0, {1000});
  results.take(event);
  results.take(made::classed(event, TrunkClass::Moderate, std::numeric_limits<double>::quiet_NaN()));
  results.take(made::step(TrialEventKind::Done, 1), 0, {1500});
  results.take(made::step(TrialEventKind::Go, 2), 0, {2000});
  results.take(made::step(TrialEventKind::Done, 2), 1, {10});
  results.finish();
  const auto figures = results.summary();
  EXPECT_EQ(value_of(figures, "reaches_detected_share"), 1.0);
  EXPECT_EQ(find(figures, "sparc_mean"), nullptr);
  EXPECT_EQ(find(figures, "trunk_sd_deg"), nullptr);
  for (const SessionFigure& figure : figures) {
    EXPECT_TRUE(std::isfinite(figure.value)) << figure.name;
    EXPECT_THAT(figure.details, testing::Not(testing::HasSubstr("nan")));
  }
}

TEST(ReachJson, WordsFromOutside_CannotBreakTheDocument) {
  JsonObject json;
  json.add("words", std::string("a\"b\\c\n\xff"));
  json.add("value", 0.5);
  json.add("infinite", std::numeric_limits<double>::infinity());
  EXPECT_EQ(json.text(), R"({"words":"a\"b\\c??","value":0.5})");
}

}  // namespace
}  // namespace dts::session
