// SPDX-License-Identifier: Apache-2.0
#include "session/reach_results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

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

using Act = std::function<void(ReachResults&)>;

Act at(TrialEventKind kind, std::uint32_t trial, std::uint64_t scan, std::uint32_t segment = 0, std::uint32_t attempt = 1) {
  return [=](ReachResults& results) { results.take(step(kind, trial, attempt), segment, {scan}); };
}
Act go(std::uint32_t trial, std::uint64_t scan, std::uint32_t segment = 0, std::uint32_t attempt = 1) {
  return [=](ReachResults& results) {
    for (const auto& [kind, later] : {std::pair{Ready, -10}, {Go, 0}, {Measure, 5}}) {
      at(kind, trial, scan + static_cast<std::uint64_t>(later), segment, attempt)(results);
    }
  };
}
Act done(std::uint32_t trial, std::uint64_t scan, std::uint32_t segment = 0, std::uint32_t attempt = 1) {
  return [=](ReachResults& results) {
    for (const TrialEventKind kind : {Done, Rest}) at(kind, trial, scan, segment, attempt)(results);
  };
}
template <class Event>
Act take(Event event) {
  return [event](ReachResults& results) { results.take(event); };
}
Act advance(std::uint32_t segment, std::uint64_t scan) {
  return [=](ReachResults& results) { results.advance(segment, {scan}); };
}
void finish(ReachResults& results) { results.finish(); }
core::ReachEvent final_at(core::ReachEvent event, std::uint64_t scan) {
  event.scan = {scan};
  return event;
}

/// "1.1 reach 2 of 1.5 mm, class 2;" of each trial.
std::string text_of(const std::vector<ReachTrialResult>& results) {
  std::ostringstream text;
  for (const ReachTrialResult& result : results) {
    text << result.trial << '.' << result.attempt << (result.has_gap ? " gap" : "");
    if (result.reach) text << " reach " << result.reach->number << " of " << result.reach->features.d2_mm() << " mm";
    if (result.movement) text << ", class " << static_cast<int>(result.movement->trunk_class);
    text << "; ";
  }
  return text.str();
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
    go(1, 1000)(results);
    for (const core::ReachEvent& event : reaches) results.take(event);
    done(1, 1500)(results);
    results.advance(0, {1500});
    ASSERT_EQ(results.results().size(), 1U);
    EXPECT_EQ(results.results()[0].reach ? results.results()[0].reach->number : 0, number);
  }
}

TEST(ReachResults, WhatIsToldInAnyOrder_GivesTheSameResults) {
  const core::ReachEvent low = reach(1, 1100, 1.0);
  const core::ReachEvent high = final_at(reach(1, 1100, 2.0), 1400);
  const core::ReachEvent other_segment = reach(1, 1100, 2.0, 1);
  const auto classed_low = classed(low, TrunkClass::Moderate, 25.0);
  for (const auto& [why, acts, expected] : std::vector<std::tuple<const char*, std::vector<Act>, const char*>>{
           {"a final told after the trial",
            {go(1, 1000), take(low), take(final_at(high, 1500)), done(1, 1500), finish},
            "1.1 reach 1 of 1 mm; "},
           {"told earlier, arrives later", {go(1, 1000), take(high), take(low), done(1, 1500), advance(0, 1500)}, "1.1 reach 1 of 2 mm; "},
           {"has not ended", {go(1, 1000), done(1, 1500), advance(0, 1499)}, ""},
           {"ended", {go(1, 1000), done(1, 1500), advance(0, 1499), take(low), advance(0, 1500)}, "1.1 reach 1 of 1 mm; "},
           {"told after the scans", {take(low), advance(0, 2000), go(1, 1000), done(1, 1500)}, "1.1 reach 1 of 1 mm; "},
           {"backwards", {done(1, 1500), take(classed_low), take(low), go(1, 1000), finish}, "1.1 reach 1 of 1 mm, class 2; "},
           {"a gap within",
            {go(1, 1000, 3), take(reach(1, 1100, 1.0, 3)), take(reach(1, 50, 1.0, 4)), done(1, 400, 4), advance(4, 400)},
            "1.1 gap; "},
           {"numbers restart in a segment",
            {go(1, 1000), take(low), take(classed_low), done(1, 1500), go(2, 1000, 1), take(other_segment),
             take(classed(other_segment, TrunkClass::Maximum, 55.0)), done(2, 1500, 1), advance(1, 1500)},
            "1.1 reach 1 of 1 mm, class 2; 2.1 reach 1 of 2 mm, class 3; "},
           {"the class of an earlier final",
            {go(1, 1000), take(low), take(classed_low), take(high), done(1, 1500), advance(0, 1500)},
            "1.1 reach 1 of 2 mm; "},
           {"redone",
            {go(1, 1000), take(low), done(1, 1500), advance(0, 1500), at(Redone, 1, 1600), go(1, 2000, 0, 2), take(reach(2, 2100)),
             done(1, 2500, 0, 2), advance(0, 2500)},
            "1.2 reach 2 of 1 mm; "},
           {"rejected, and that undone",
            {go(1, 1000), take(low), done(1, 1500), advance(0, 1500), at(Rejected, 1, 1600), at(Undone, 1, 1700)},
            "1.1 reach 1 of 1 mm; "},
           {"rejected before its end, undone after it",
            {go(1, 1000), take(low), at(Rejected, 1, 1400), advance(0, 1600), at(Undone, 1, 1600), done(1, 1500), advance(0, 1700)},
            "1.1 reach 1 of 1 mm; "},
           {"the same in the order of scans",
            {go(1, 1000), take(low), at(Rejected, 1, 1400), advance(0, 1500), done(1, 1500), advance(0, 1600), at(Undone, 1, 1600)},
            "1.1 reach 1 of 1 mm; "},
           {"redone, and that undone: the other attempt is void",
            {go(1, 1000), take(low), done(1, 1500), at(Redone, 1, 1510), go(1, 1520, 0, 2), take(reach(2, 1530)), at(Undone, 1, 1600),
             done(1, 1900, 0, 2), advance(0, 2000)},
            "1.1 reach 1 of 1 mm; "},
           {"rejected before it was asked for", {go(1, 1000), done(1, 1500), advance(0, 1500), at(Rejected, 1, 1510)}, ""},
           {"without cue or end", {go(1, 1000), done(2, 1500), go(3, 2000), at(Aborted, 3, 2100), at(Finished, 0, 2200), finish}, ""},
       }) {
    ReachResults results = without_model();
    for (const Act& act : acts) act(results);
    EXPECT_EQ(text_of(results.take_decided()), expected) << why;
    EXPECT_TRUE(results.take_decided().empty()) << why;
    EXPECT_EQ(text_of(results.results()), expected) << why;
  }
}

TEST(ReachResults, ThousandsOfEventsWithoutATrial_LeaveTheNewestForTheNext) {
  ReachResults results = without_model();
  for (std::uint32_t k = 1; k <= 50'000; ++k) {
    const core::ReachEvent event = reach(k, std::uint64_t{k} * 10);
    results.take(event);
    results.take(classed(event, TrunkClass::Minor, 5.0));
  }
  go(1, 499'000)(results);
  done(1, 600'000)(results);
  results.finish();
  EXPECT_EQ(text_of(results.results()), "1.1 reach 49898 of 1 mm, class 1; ");
}

TEST(ReachResults, EndlessAttempts_StopBeingKept) {
  ReachResults results = without_model();
  for (std::uint32_t k = 1; k <= ReachResults::kMostAttempts + 1000; ++k) results.take(step(Rejected, k), 0, {k});
  go(500'000, 1'000'000)(results);
  done(500'000, 1'000'500)(results);
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
  RecordProperty("requirement", "REACH-7");
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
