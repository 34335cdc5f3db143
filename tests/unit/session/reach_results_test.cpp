// SPDX-License-Identifier: Apache-2.0
#include "session/reach_results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "reach_results_events.h"

namespace dts::session {
namespace {

using core::ReachStep;
using core::TrunkClass;
using made::classed;
using made::reach;
using made::step;
using enum TrialEventKind;

ReachResults without_model() { return {made::volunteer(), nullptr}; }

void go(ReachResults& results, std::uint32_t trial, std::uint64_t scan, std::uint32_t segment = 0, std::uint32_t attempt = 1) {
  results.take(step(Ready, trial, attempt), segment, {scan - 10});
  results.take(step(Go, trial, attempt), segment, {scan});
  results.take(step(Measure, trial, attempt), segment, {scan + 5});
}
void done(ReachResults& results, std::uint32_t trial, std::uint64_t scan, std::uint32_t segment = 0, std::uint32_t attempt = 1) {
  results.take(step(Done, trial, attempt), segment, {scan});
  results.take(step(Rest, trial, attempt), segment, {scan});
}
/// Number of the reach in the only result; 0: it has none.
std::uint32_t only_reach(const ReachResults& results) {
  const auto all = results.results();
  EXPECT_EQ(all.size(), 1U);
  return all.empty() || !all[0].reach ? 0 : all[0].reach->number;
}

TEST(ReachResults, Trial_HasTheLargestReachWhoseTrunkWentForwardInIt) {
  core::ReachEvent late = reach(3, 1480);
  late.scan = {1499};
  core::ReachEvent provisional = reach(1, 1100);
  provisional.step = ReachStep::P3;
  std::vector<core::ReachEvent> unmeasured(3, reach(2, 1200));
  unmeasured[0].features.p1_mm = unmeasured[1].features.p2_mm = unmeasured[2].features.p3_mm = std::numeric_limits<double>::quiet_NaN();
  const core::ReachEvent cancelled{.step = ReachStep::Cancelled, .number = 1, .segment = 0, .scan = {1300}};
  struct Row {
    const char* what;
    std::vector<core::ReachEvent> reaches;
    std::uint32_t number;  ///< 0: none.
  };
  for (const auto& [what, reaches, number] :
       std::vector<Row>{{"P2 is 20 scans after P1", {reach(4, 979)}, 0},
                        {"", {reach(4, 979), reach(5, 980)}, 5},
                        {"goes forward when the trial is done", {late}, 0},
                        {"provisional, or not measured", {provisional, unmeasured[0], unmeasured[1], unmeasured[2]}, 0},
                        {"cancelled", {reach(1, 1100), cancelled}, 0},
                        {"several", {reach(1, 1050, 0.5), reach(2, 1200, 1.5), reach(3, 1350, 0.7)}, 2}}) {
    SCOPED_TRACE(what);
    ReachResults results = without_model();
    go(results, 1, 1000);
    for (const core::ReachEvent& event : reaches) results.take(event);
    done(results, 1, 1500);
    results.advance(0, {1500});
    EXPECT_EQ(only_reach(results), number);
  }
}

TEST(ReachResults, FinalToldAfterTheTrial_DoesNotCount) {
  ReachResults results = without_model();
  go(results, 1, 1000);
  results.take(reach(1, 1100, 1.0));
  core::ReachEvent higher = reach(1, 1100, 2.0);
  higher.scan = {1500};
  results.take(higher);
  done(results, 1, 1500);
  results.finish();
  const auto all = results.results();
  ASSERT_EQ(all.size(), 1U);
  ASSERT_TRUE(all[0].reach.has_value());
  EXPECT_DOUBLE_EQ(all[0].reach->features.d2_mm(), 1.0);
}

TEST(ReachResults, OtherFinalOfTheSameNumber_ReplacesTheFirst) {
  ReachResults results = without_model();
  go(results, 1, 1000);
  core::ReachEvent higher = reach(1, 1100, 2.0);
  higher.scan = {1400};
  results.take(higher);
  results.take(reach(1, 1100, 1.0));  // told earlier, arrives later
  done(results, 1, 1500);
  results.advance(0, {1500});
  EXPECT_DOUBLE_EQ(results.results().at(0).reach->features.d2_mm(), 2.0);
}

TEST(ReachResults, Advance_DecidesOnlyWhatHasEnded) {
  ReachResults results = without_model();
  go(results, 1, 1000);
  done(results, 1, 1500);
  results.advance(0, {1499});
  EXPECT_TRUE(results.take_decided().empty());
  results.take(reach(1, 1100));
  results.advance(0, {1500});
  const auto decided = results.take_decided();
  ASSERT_EQ(decided.size(), 1U);
  EXPECT_TRUE(decided[0].reach.has_value());
  EXPECT_TRUE(results.take_decided().empty());
}

TEST(ReachResults, StepsToldAfterTheScansTheyStandAt_AreDecidedAtOnce) {
  ReachResults results = without_model();
  results.take(reach(1, 1100));
  results.advance(0, {2000});
  go(results, 1, 1000);
  done(results, 1, 1500);
  EXPECT_EQ(results.take_decided().size(), 1U);
  EXPECT_EQ(only_reach(results), 1U);
}

TEST(ReachResults, EverythingBackwards_GivesTheSame) {
  ReachResults results = without_model();
  const core::ReachEvent event = reach(7, 1100);
  done(results, 1, 1500);
  results.take(classed(event, TrunkClass::Moderate, 25.0));
  results.take(event);
  go(results, 1, 1000);
  results.finish();
  ASSERT_EQ(only_reach(results), 7U);
  EXPECT_EQ(results.results()[0].movement->trunk_class, TrunkClass::Moderate);
}

TEST(ReachResults, GapWithinTheTrial_LeavesItWithoutResultAndSaysSo) {
  ReachResults results = without_model();
  go(results, 1, 1000, 3);
  results.take(reach(1, 1100, 1.0, 3));
  results.take(reach(1, 50, 1.0, 4));
  done(results, 1, 400, 4);
  results.advance(4, {400});
  const auto all = results.results();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_TRUE(all[0].has_gap);
  EXPECT_FALSE(all[0].reach.has_value());
  EXPECT_FALSE(all[0].movement.has_value());
}

TEST(ReachResults, NumbersRestartInANewSegment_AreOtherReaches) {
  ReachResults results = without_model();
  go(results, 1, 1000, 0);
  const core::ReachEvent first = reach(1, 1100, 1.0, 0);
  results.take(first);
  results.take(classed(first, TrunkClass::Moderate, 25.0));
  done(results, 1, 1500, 0);
  go(results, 2, 1000, 1);
  const core::ReachEvent second = reach(1, 1100, 2.0, 1);
  results.take(second);
  results.take(classed(second, TrunkClass::Maximum, 55.0));
  done(results, 2, 1500, 1);
  results.advance(1, {1500});
  const auto all = results.results();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].movement->trunk_class, TrunkClass::Moderate);
  EXPECT_EQ(all[1].movement->trunk_class, TrunkClass::Maximum);
}

TEST(ReachResults, ClassOfAnEarlierFinal_IsNotThatOfTheLast) {
  ReachResults results = without_model();
  go(results, 1, 1000);
  const core::ReachEvent first = reach(1, 1100, 1.0);
  results.take(first);
  results.take(classed(first, TrunkClass::Moderate, 25.0));
  core::ReachEvent second = reach(1, 1100, 2.0);
  second.scan = {1400};
  results.take(second);
  done(results, 1, 1500);
  results.advance(0, {1500});
  EXPECT_FALSE(results.results().at(0).movement.has_value());
}

TEST(ReachResults, RedoneTrial_CountsOnceByItsLastAttempt) {
  ReachResults results = without_model();
  go(results, 1, 1000);
  results.take(reach(1, 1100));
  done(results, 1, 1500);
  results.advance(0, {1500});
  EXPECT_EQ(results.take_decided().size(), 1U);
  results.take(step(Redone, 1, 1), 0, {1600});
  go(results, 1, 2000, 0, 2);
  results.take(reach(2, 2100));
  done(results, 1, 2500, 0, 2);
  results.advance(0, {2500});
  EXPECT_EQ(only_reach(results), 2U);
  EXPECT_EQ(results.results()[0].attempt, 2U);
}

TEST(ReachResults, RejectedBeforeItWasAskedFor_IsNotDecided) {
  ReachResults results = without_model();
  go(results, 1, 1000);
  done(results, 1, 1500);
  results.advance(0, {1500});
  results.take(step(Rejected, 1), 0, {1510});
  EXPECT_TRUE(results.take_decided().empty());
  EXPECT_TRUE(results.results().empty());
  EXPECT_TRUE(results.summary().empty());
}

TEST(ReachResults, TrialsWithoutCueOrEnd_AreNone) {
  ReachResults results = without_model();
  go(results, 1, 1000);
  done(results, 2, 1500);
  go(results, 3, 2000);
  results.take(step(Aborted, 3), 0, {2100});
  results.take(step(Finished, 0), 0, {2200});
  results.finish();
  EXPECT_TRUE(results.results().empty());
}

TEST(ReachResults, ThousandsOfEventsWithoutATrial_LeaveTheNewestForTheNext) {
  ReachResults results = without_model();
  for (std::uint32_t k = 1; k <= 50'000; ++k) {
    const core::ReachEvent event = reach(k, std::uint64_t{k} * 10);
    results.take(event);
    results.take(classed(event, TrunkClass::Minor, 5.0));
  }
  go(results, 1, 499'000);
  done(results, 1, 600'000);
  results.finish();
  EXPECT_GE(only_reach(results), 49'898U);
  EXPECT_TRUE(results.results()[0].movement.has_value());
}

TEST(ReachResults, EndlessAttempts_StopBeingKept) {
  ReachResults results = without_model();
  for (std::uint32_t k = 1; k <= ReachResults::kMostAttempts + 1000; ++k) results.take(step(Rejected, k), 0, {k});
  go(results, 500'000, 1'000'000);
  done(results, 500'000, 1'000'500);
  results.finish();
  EXPECT_TRUE(results.results().empty());
}

/// Told: the class of the pipeline's model. The model here rejects everything: what it said shows.
std::vector<core::TrunkClass> classes_after(const std::vector<core::ReachEvent>& maxima, bool has_stroke = false) {
  const classifier::TrunkModel model;
  physics::Person person = made::volunteer();
  person.has_stroke = has_stroke;
  ReachResults results(person, &model);
  std::uint32_t trial = 0;
  for (const core::ReachEvent& event : maxima) {
    ++trial;
    results.take(step(Go, trial, 1, "max", 124.0), 0, {event.p1.scan.value - 50});
    results.take(event);
    results.take(classed(event, TrunkClass::Maximum, 55.0));
    results.take(step(Done, trial, 1, "max", 124.0), 0, {event.p1.scan.value + 450});
  }
  results.finish();
  std::vector<core::TrunkClass> classes;
  for (const ReachTrialResult& result : results.take_decided()) classes.push_back(result.movement->trunk_class);
  return classes;
}

/// Each is told by what was known when it was decided, however many are decided at once.
TEST(ReachResults, ThreeMaximumReaches_BringTheSubjectsOwnScale) {
  using testing::Each;
  using testing::ElementsAre;
  EXPECT_THAT(classes_after({reach(1, 1050, 2.0), reach(2, 2050, 2.1)}), Each(TrunkClass::Maximum));
  EXPECT_THAT(classes_after({reach(1, 1050, 2.0), reach(2, 2050, 2.1), reach(3, 3050, 1.9)}),
              ElementsAre(TrunkClass::Maximum, TrunkClass::Maximum, TrunkClass::Rejected));
}

TEST(ReachResults, AfterAStroke_ThereIsNoOwnScale) {
  EXPECT_THAT(classes_after({reach(1, 1050, 2.0), reach(2, 2050, 2.1), reach(3, 3050, 1.9)}, true), testing::Each(TrunkClass::Maximum));
}

TEST(ReachResults, DoubtfulMaximumReach_SetsNoScale) {
  for (const std::uint16_t flag : {core::reach_flag::kMinor, core::reach_flag::kSubstituted, core::reach_flag::kBaselineUncertain}) {
    core::ReachEvent doubtful = reach(2, 2050, 2.1);
    doubtful.flags = flag;
    EXPECT_THAT(classes_after({reach(1, 1050, 2.0), doubtful, reach(3, 3050, 1.9)}), testing::Each(TrunkClass::Maximum)) << flag;
  }
}

TEST(ReachResults, MaximumReachesThatDisagree_WaitForThreeThatDoNot) {
  EXPECT_THAT(classes_after({reach(1, 1050, 0.3), reach(2, 2050, 2.1), reach(3, 3050, 0.9)}), testing::Each(TrunkClass::Maximum));
  EXPECT_EQ(classes_after({reach(1, 1050, 0.3), reach(2, 2050, 2.1), reach(3, 3050, 0.9), reach(4, 4050, 2.0)}).back(),
            TrunkClass::Rejected);
}

TEST(ReachResults, Expected_FollowsTheFlexionThatTheTargetTakes) {
  const auto person = std::optional(made::volunteer());
  EXPECT_EQ(expected_class(person, 67.0), TrunkClass::None);
  EXPECT_EQ(expected_class(person, 80.4), TrunkClass::Minor);
  EXPECT_EQ(expected_class(person, 100.5), TrunkClass::Moderate);
  EXPECT_EQ(expected_class(person, 124.0), TrunkClass::Maximum);
  EXPECT_EQ(expected_class(person, std::nullopt), std::nullopt);
  EXPECT_EQ(expected_class(std::nullopt, 124.0), std::nullopt);
  EXPECT_EQ(expected_class(person, std::numeric_limits<double>::quiet_NaN()), std::nullopt);
}

TEST(ReachResults, PersonOf_NeedsAllFourMeasures) {
  const std::vector<std::pair<std::string, std::string>> whole{
      {"side", "left"}, {"weight_kg", "68"}, {"height_cm", "175"}, {"arm_length_cm", "67"}, {"max_reach_cm", "124.5"}};
  const auto person = person_of(whole);
  ASSERT_TRUE(person.has_value());
  EXPECT_EQ(person->max_reach_cm, 124.5);
  EXPECT_FALSE(person->has_stroke);
  auto stroke = whole;
  stroke.emplace_back("group", "stroke");
  EXPECT_TRUE(person_of(stroke)->has_stroke);
  for (std::size_t k = 1; k < whole.size(); ++k) {
    auto fields = whole;
    fields[k].second = k % 2 == 0 ? "0" : "tall";
    EXPECT_FALSE(person_of(fields).has_value()) << fields[k].first;
    fields.erase(fields.begin() + static_cast<std::ptrdiff_t>(k));
    EXPECT_FALSE(person_of(fields).has_value());
  }
}

}  // namespace
}  // namespace dts::session
