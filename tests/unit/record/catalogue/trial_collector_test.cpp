// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/trial_collector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace dts::record {
namespace {

using testing::ElementsAre;

TimedEvent event(const std::string& phase, std::int64_t trial, std::int64_t attempt, std::uint64_t scan, std::uint32_t segment = 0) {
  RecordedEvent told{.event = "trial", .segment = segment, .scan = {scan}};
  told.values = {{"phase", phase}, {"trial", trial}, {"attempt", attempt}, {"block", std::int64_t{2}}, {"condition", std::string("120")}};
  return {.event = told};
}
RecordedScans scans(std::size_t stream, std::uint32_t segment, std::uint64_t first_scan, std::size_t count) {
  return {.stream = stream, .segment = segment, .first_scan = {first_scan}, .count = count};
}

/// "1.1 done 0:20-0:99": trial.attempt, outcome, from and to as segment:scan.
std::string shown(const TrialRow& row) {
  return std::to_string(row.trial) + "." + std::to_string(row.attempt) + " " + row.outcome + " " + std::to_string(row.segment) + ":" +
         std::to_string(row.first_scan) + "-" + std::to_string(row.last_segment) + ":" + std::to_string(row.last_scan);
}
std::vector<std::string> collected(const std::vector<RecordedItem>& items) {
  TrialCollector trials(0);
  for (const RecordedItem& item : items) trials.take(item);
  std::vector<std::string> rows;
  for (const TrialRow& row : trials.rows()) rows.push_back(shown(row));
  return rows;
}

TEST(TrialCollector, NoTrials_HasNoRows) {
  EXPECT_THAT(collected({scans(0, 0, 0, 10), TimedEvent{.event = {.event = "marker"}}}), ElementsAre());
}

TEST(TrialCollector, Done_CountsFromMeasure) {
  EXPECT_THAT(collected({event("ready", 1, 1, 10), event("go", 1, 1, 15), event("measure", 1, 1, 20), event("done", 1, 1, 99),
                         event("rest", 1, 1, 99)}),
              ElementsAre("1.1 done 0:20-0:99"));
}

TEST(TrialCollector, BlockAndCondition_AreKept) {
  TrialCollector trials(std::nullopt);
  trials.take(event("ready", 1, 1, 10));
  EXPECT_EQ(trials.rows().at(0).block, 2U);
  EXPECT_EQ(trials.rows().at(0).condition, "120");
}

TEST(TrialCollector, VoidedUnderWay_EndsThere) {
  EXPECT_THAT(collected({event("ready", 1, 1, 10), event("redone", 1, 1, 12), event("ready", 1, 2, 12), event("measure", 1, 2, 20),
                         event("rejected", 1, 2, 30)}),
              ElementsAre("1.1 redone 0:10-0:12", "1.2 rejected 0:20-0:30"));
}

TEST(TrialCollector, VoidedAfterItWasDone_KeepsItsEnd) {
  EXPECT_THAT(collected({event("measure", 1, 1, 20), event("done", 1, 1, 99), event("rejected", 1, 1, 500)}),
              ElementsAre("1.1 rejected 0:20-0:99"));
}

TEST(TrialCollector, GapWithin_NamesBothSegments) {
  EXPECT_THAT(collected({event("measure", 1, 1, 900), event("done", 1, 1, 40, 1)}), ElementsAre("1.1 done 0:900-1:40"));
}

TEST(TrialCollector, RecordingEndsWithin_AbortedAtTheLastRawScan) {
  EXPECT_THAT(collected({event("measure", 1, 1, 20), scans(0, 0, 100, 50), scans(1, 0, 9000, 50), scans(0, 0, 0, 0)}),
              ElementsAre("1.1 aborted 0:20-0:149"));
}

TEST(TrialCollector, EventsOutOfTheBlue_AreTakenForWhatTheySay) {
  EXPECT_THAT(collected({event("done", 4, 1, 70)}), ElementsAre("4.1 done 0:70-0:70"));
}

TEST(TrialCollector, StartOfATrialThatIsOver_DoesNotMoveIt) {
  EXPECT_THAT(collected({event("measure", 1, 1, 20), event("done", 1, 1, 99), event("ready", 1, 1, 200)}),
              ElementsAre("1.1 done 0:20-0:99"));
}

TEST(TrialCollector, NonsenseOfAStranger_IsPassedOver) {
  TimedEvent texts = event("ready", 1, 1, 0);
  texts.event.values[1].second = std::string("1");
  EXPECT_THAT(collected({event("ready", 0, 1, 1), event("ready", -5, 1, 1), event("ready", 1, 0, 1), event("ready", 1LL << 40, 1, 1),
                         event("dance", 1, 1, 1), texts, TimedEvent{.event = {.event = "trial"}}}),
              ElementsAre());
}

TEST(TrialCollector, ResultAndFigures_AreKeptAsTold) {
  TrialCollector trials(0);
  RecordedEvent result{.event = "result", .scan = {120}};
  result.values = {{"trial", std::int64_t{1}}, {"attempt", std::int64_t{1}}, {"class", std::int64_t{2}}};
  RecordedEvent stray = result;
  stray.values[0].second = std::int64_t{9};
  RecordedEvent figure{.event = "figure", .scan = {130}};
  figure.values = {{"name", std::string("rejected_share")}, {"value", 0.25}, {"unit", std::string("1")}, {"details", std::string()}};
  RecordedEvent undefined = figure;
  undefined.values[0].second = std::string("other");
  undefined.values[1].second = std::numeric_limits<double>::quiet_NaN();
  RecordedEvent nameless = figure;
  nameless.values[0].second = std::string();

  trials.take(event("measure", 1, 1, 20));
  trials.take(event("done", 1, 1, 99));
  for (const RecordedEvent& told : {result, stray, figure, undefined, nameless}) trials.take(TimedEvent{.event = told});

  ASSERT_EQ(trials.rows().size(), 1U);
  EXPECT_EQ(trials.rows()[0].result, to_json(result));
  ASSERT_EQ(trials.figures().size(), 1U);
  EXPECT_EQ(trials.figures()[0].name, "rejected_share");
  EXPECT_EQ(trials.figures()[0].value, 0.25);
}

}  // namespace
}  // namespace dts::record
