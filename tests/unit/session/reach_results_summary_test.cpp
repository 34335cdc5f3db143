// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

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
  tell_trial(results, 1, 1000, "100", 67.0, 0.125, TrunkClass::None, 1.0);
  tell_trial(results, 2, 2000, "120", 80.4, 0.25, TrunkClass::Minor, 4.0);
  tell_trial(results, 3, 3000, "150", 100.5, 0.75, TrunkClass::Moderate, 24.0);
  tell_trial(results, 4, 4000, "100", 67.0, 0.375, TrunkClass::Minor, 3.0);
  tell_trial(results, 5, 5000, "120", 80.4, 0.5, TrunkClass::Rejected, 8.0);
  tell_trial(results, 6, 6000, "150", 100.5, 1.0, TrunkClass::Moderate, 28.0);
  return results;
}

/// The critical boundary is the target nearest to the fingertips, 120 %; one of its two reaches is unsure.
TEST(ReachSummary, Figures_AreSharesMeansAndSpreadsWithinTargets) {
  std::ostringstream text;
  text << std::setprecision(12);
  for (const SessionFigure& figure : session().summary()) {
    text << figure.name << " = " << figure.value << ' ' << figure.unit << ' ' << figure.details << '\n';
  }
  EXPECT_EQ(
      text.str(),
      "trials = 6 1 \n"
      "reaches_detected_share = 1 1 {\"detected\":6,\"trials_without_gap\":6}\n"
      "rejected_share = 0.166666666667 1 {\"rejected\":1,\"classified\":6}\n"
      "class_agreement_share = 0.8 1 {\"agreed\":4,\"compared\":5}\n"
      "trunk_at_critical_boundary_deg = 6 deg "
      "{\"condition\":\"120\",\"target_cm\":80.4,\"arm_lengths\":1.2000000000000002,\"trials\":2,\"angles\":2,\"sd_deg\":2."
      "8284271247461903}\n"
      "trunk_sd_deg = 2.44948974278 deg \n"
      "d2_sd_mm = 0.176776695297 mm \n"
      "sparc_mean = -1.6 1 \n"
      "targets = 3 1 "
      "{\"targets\":[{\"condition\":\"100\",\"target_cm\":67,\"expected_class\":0,\"trials\":2,\"with_gap\":0,\"reaches_detected\":2,"
      "\"classes\":{\"none\":1,\"minor\":1,\"moderate\":0,\"maximum\":0,\"rejected\":0},\"agreed\":1,\"compared\":2,\"d2_mean_mm\":0.25,"
      "\"d2_sd_mm\":0.1767766952966369,\"angles\":2,\"angles_on_own_scale\":0,\"trunk_mean_deg\":2,\"trunk_sd_deg\":1.4142135623730951,"
      "\"sparc_mean\":-1.6,\"sparc_"
      "sd\":0},{"
      "\"condition\":\"120\",\"target_cm\":80.4,\"expected_class\":1,\"trials\":2,\"with_gap\":0,\"reaches_detected\":2,\"classes\":{"
      "\"none\":0,\"minor\":1,\"moderate\":0,\"maximum\":0,\"rejected\":1},\"agreed\":1,\"compared\":1,\"d2_mean_mm\":0.375,\"d2_sd_mm\":0."
      "1767766952966369,\"angles\":2,\"angles_on_own_scale\":0,\"trunk_mean_deg\":6,\"trunk_sd_deg\":2.8284271247461903,\"sparc_mean\":-1."
      "6,\"sparc_sd\":0},{"
      "\"condition\":"
      "\"150\",\"target_cm\":100.5,\"expected_class\":2,\"trials\":2,\"with_gap\":0,\"reaches_detected\":2,\"classes\":{\"none\":0,"
      "\"minor\":0,\"moderate\":2,\"maximum\":0,\"rejected\":0},\"agreed\":2,\"compared\":2,\"d2_mean_mm\":0.875,\"d2_sd_mm\":0."
      "1767766952966369,\"angles\":2,\"angles_on_own_scale\":0,\"trunk_mean_deg\":26,\"trunk_sd_deg\":2.8284271247461903,\"sparc_mean\":-1."
      "6,\"sparc_sd\":0}]}\n");
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

TEST(ReachSummary, AnglesOnTheOwnScale_AreCounted) {
  ReachResults results(made::volunteer(), nullptr);
  const core::ReachEvent event = made::reach(1, 1050);
  core::ClassEvent own = made::classed(event, TrunkClass::Minor, 4.0);
  own.movement.reasons = core::class_reason::kCalibrated;
  results.take(made::step(TrialEventKind::Go, 1, 1, "120", 80.4), 0, {1000});
  results.take(event);
  results.take(own);
  results.take(made::step(TrialEventKind::Done, 1, 1, "120", 80.4), 0, {1500});
  tell_trial(results, 2, 2000, "120", 80.4, 0.2, TrunkClass::Minor, 4.0);
  results.finish();
  const auto figures = results.summary();
  EXPECT_THAT(find(figures, "targets")->details, ::testing::HasSubstr("\"angles\":2,\"angles_on_own_scale\":1,"));
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
