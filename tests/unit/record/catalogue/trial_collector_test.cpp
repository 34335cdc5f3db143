// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/trial_collector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "dts/wire/event_json.h"
#include "support/event_text.h"

namespace dts::record {
namespace {

using testing::ElementsAre;

using test::event_of;

TimedEvent event(const std::string& step, std::uint32_t trial, std::uint32_t attempt, std::uint64_t scan, std::uint32_t segment = 0) {
  std::string name = step;
  std::ranges::transform(name, name.begin(), [](char letter) { return static_cast<char>(letter - 'a' + 'A'); });
  return {.event = event_of("segment: " + std::to_string(segment) + " scan: " + std::to_string(scan) + " trial { step: TRIAL_EVENT_KIND_" +
                            name + " trial: " + std::to_string(trial) + " attempt: " + std::to_string(attempt) +
                            " block: 2 condition: '120' }")};
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
  for (const RecordedItem& item : items) trials.add(item);
  std::vector<std::string> rows;
  for (const TrialRow& row : trials.rows()) rows.push_back(shown(row));
  return rows;
}

TEST(TrialCollector, NoTrials_HasNoRows) {
  EXPECT_THAT(collected({scans(0, 0, 0, 10), TimedEvent{.event = event_of("marker {}")}}), ElementsAre());
}

TEST(TrialCollector, Done_CountsFromMeasure) {
  EXPECT_THAT(collected({event("ready", 1, 1, 10), event("go", 1, 1, 15), event("measure", 1, 1, 20), event("done", 1, 1, 99),
                         event("rest", 1, 1, 99)}),
              ElementsAre("1.1 done 0:20-0:99"));
}

TEST(TrialCollector, BlockAndCondition_AreKept) {
  TrialCollector trials(std::nullopt);
  trials.add(event("ready", 1, 1, 10));
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

TEST(TrialCollector, Undone_IsAsIfNothingHadHappened) {
  EXPECT_THAT(collected({event("measure", 1, 1, 20), event("done", 1, 1, 99), event("rejected", 1, 1, 200), event("undone", 1, 1, 300)}),
              ElementsAre("1.1 done 0:20-0:99"));
  EXPECT_THAT(collected({event("measure", 1, 1, 20), event("rejected", 1, 1, 50), event("undone", 1, 1, 120), event("done", 1, 1, 99)}),
              ElementsAre("1.1 done 0:20-0:99"));
  EXPECT_THAT(collected({event("measure", 1, 1, 20), event("rejected", 1, 1, 50), event("done", 1, 1, 99), event("undone", 1, 1, 120)}),
              ElementsAre("1.1 done 0:20-0:99"))
      << "in the order of times";
  EXPECT_THAT(collected({event("ready", 1, 1, 10), event("rejected", 1, 1, 12), event("undone", 1, 1, 30), event("measure", 1, 1, 20),
                         event("done", 1, 1, 99)}),
              ElementsAre("1.1 done 0:20-0:99"));
  EXPECT_THAT(collected({event("measure", 1, 1, 20), event("redone", 1, 1, 50), event("ready", 1, 2, 50), event("undone", 1, 1, 60),
                         event("done", 1, 1, 99), event("redone", 1, 1, 120), event("ready", 1, 3, 120), event("done", 1, 3, 140)}),
              ElementsAre("1.1 redone 0:20-0:99", "1.3 done 0:120-0:140"));
}

TEST(TrialCollector, AnAttemptThatAnUndoTookBack_HasBegun) {
  TrialCollector trials(0);
  for (const TimedEvent& one : {event("measure", 1, 1, 20), event("redone", 1, 1, 50), event("ready", 1, 2, 50), event("undone", 1, 1, 60),
                                event("done", 1, 1, 99), event("ready", 2, 1, 120)}) {
    trials.add(one);
  }
  EXPECT_THAT(trials.begun_attempts(), ElementsAre(testing::Pair(1, 2), testing::Pair(2, 1)));
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
  EXPECT_THAT(collected({event("ready", 0, 1, 1), event("ready", 1, 0, 1), event("ready", 4'000'000'000, 1, 1),
                         TimedEvent{.event = event_of("trial { step: 99 trial: 1 attempt: 1 }")}, TimedEvent{.event = event_of("trial {}")},
                         TimedEvent{}}),
              ElementsAre());
}

TEST(TrialCollector, ResultAndFigures_AreKeptAsTold) {
  TrialCollector trials(0);
  const v1::Event result = event_of("scan: 120 trial_result { trial: 1 attempt: 1 movement { trunk_class: 2 } }");
  const v1::Event stray = event_of("scan: 120 trial_result { trial: 9 attempt: 1 }");
  const v1::Event running = event_of("scan: 125 sway { trial: 1 attempt: 1 is_preliminary: true }");
  const v1::Event figure = event_of("scan: 130 figure { name: 'rejected_share' value: 0.25 unit: '1' }");
  const v1::Event undefined = event_of("scan: 130 figure { name: 'other' value: nan }");
  const v1::Event nameless = event_of("scan: 130 figure { value: 1 }");

  trials.add(event("measure", 1, 1, 20));
  trials.add(event("done", 1, 1, 99));
  for (const v1::Event& told : {result, stray, running, figure, undefined, nameless}) trials.add(TimedEvent{.event = told});

  ASSERT_EQ(trials.rows().size(), 1U);
  EXPECT_EQ(trials.rows()[0].result, wire::to_json(result));
  ASSERT_EQ(trials.session_results().size(), 1U);
  EXPECT_EQ(trials.session_results()[0].name, "rejected_share");
  EXPECT_EQ(trials.session_results()[0].value, 0.25);
}

}  // namespace
}  // namespace dts::record
