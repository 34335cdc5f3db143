// SPDX-License-Identifier: Apache-2.0
// A session from its start to its end and its resumption: recording, trials, results.
#include "session/rig_session.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <future>
#include <set>

#include "record/old_event.h"
#include "record/recording.h"
#include "record/sha256.h"
#include "session/recorded_sway.h"
#include "supervisor_fixture.h"

namespace dts::session {
namespace {

using core::ErrorCode;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class RigSessionTest : public SupervisorTest {};

TEST_F(RigSessionTest, SessionFacts_StandInItsRecording) {
  config_.definition = "name = floor";
  config_.trunk_model_text = "model";
  Protocol protocol = standing();
  protocol.fields = {{.name = "age_years", .minimum = 3, .maximum = 120}};
  start({Protocol{}, protocol});
  device_->found.serial = "F8";
  const std::int64_t utc_ns = clock_.now_ns() + clock_.utc_minus_monotonic_ns();
  const std::string id = record(
      30, {.protocol = "standing", .subject = "P1", .label = "left", .duration_s = 90.0, .settle_s = 0.1, .fields = {{"age_years", "30"}}});
  ASSERT_TRUE(stop());

  auto facts = record::Recording::open(row(id).parts.at(0).file).value()->session().value();
  EXPECT_EQ(facts.session_id, id);
  EXPECT_EQ(facts.part, 1U);
  EXPECT_EQ(facts.rig + " " + facts.kind + " " + facts.protocol + " " + facts.subject + " " + facts.label, "floor floor standing P1 left");
  EXPECT_EQ(facts.fields, (std::vector<std::pair<std::string, std::string>>{{"age_years", "30"}}));
  EXPECT_EQ(facts.duration_s, 90.0);
  EXPECT_EQ(facts.settle_s, 0.1);
  EXPECT_EQ(facts.started_utc_ns, utc_ns);
  EXPECT_EQ(facts.utc_minus_monotonic_ns, clock_.utc_minus_monotonic_ns());
  EXPECT_EQ(facts.boot_id + ", " + facts.software + ", " + facts.firmware, "boot 1, dtsd test, 1.2");
  EXPECT_EQ(facts.device_uri + " " + facts.device_model + " " + facts.device_serial, "hand:fed Hand-fed device F8");
  EXPECT_EQ(facts.rig_definition + ", " + facts.protocol_definition, "name = floor, name = standing");
  EXPECT_EQ(facts.model_sha256, record::sha256_of("model"));
  EXPECT_EQ(facts.stages, rig().stage_texts());
  const std::uint64_t seed = facts.plan_seed;

  ASSERT_TRUE(supervisor_->resume_session(id));
  feed(kBlock);
  ASSERT_TRUE(stop());
  const record::PartRow second = row(id).parts.at(1);
  facts = record::Recording::open(second.file).value()->session().value();
  EXPECT_EQ(facts.part, 2U);
  EXPECT_EQ(facts.plan_seed, seed) << "the same order of trials";
  EXPECT_EQ(facts.duration_s, 90.0);
  EXPECT_EQ(facts.subject + facts.label, "P1left");
  EXPECT_EQ(facts.fields.size(), 1U);
  EXPECT_THAT(second.file, testing::EndsWith(id + ".2.xdf"));
  EXPECT_NE(record::Recording::open(row(record(30, {.protocol = "standing"})).parts.at(0).file).value()->session()->plan_seed, seed);
}

TEST_F(RigSessionTest, SessionThatDoesNotFit_IsRefused) {
  Protocol chair{.name = "chair", .rig_kind = "chair"};
  start({Protocol{}, standing(), chair});
  const auto refused = [&](const SessionRequest& request) {
    return why_refused(supervisor_->start_session("floor", request), ErrorCode::InvalidArgument);
  };
  EXPECT_THAT(refused({.protocol = std::string(70, 'x')}),
              AllOf(HasSubstr("unknown protocol '" + std::string(64, 'x') + "'; known: free, standing, chair")));
  EXPECT_THAT(refused({.protocol = "chair"}), HasSubstr("protocol 'chair' is for a chair, and rig 'floor' is a floor"));
  EXPECT_NE(refused({.label = std::string(201, 'x')}), "");
  EXPECT_NE(refused({.fields = {{"age_years", "3"}}}), "");
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "sessions"));
  EXPECT_THAT(why_refused(supervisor_->resume_session("none"), ErrorCode::NotFound), HasSubstr("none"));
}

TEST_F(RigSessionTest, Trials_BeginAtTheirScansHoweverLateTheyAreNoticed) {
  start({standing()});
  ASSERT_TRUE(supervisor_->start_session("floor", {.protocol = "standing"}));
  const auto early = supervisor_->trial("", TrialAction::Next);
  ASSERT_TRUE(early) << "counts as soon as the session runs";
  EXPECT_TRUE(early->is_next_wanted);
  EXPECT_THAT(why_refused(supervisor_->trial("", TrialAction::Redo)), HasSubstr("the session is starting, not running"));
  static_cast<void>(taken_events(v1::Event::kTrial));
  pass(0.3, 0.3);
  pass(0.3, 0.3);
  const auto events = taken_events(v1::Event::kTrial);
  std::vector<std::pair<TrialEventKind, std::uint64_t>> steps;
  const auto add = [&steps](const v1::Event& event) {
    steps.emplace_back(static_cast<TrialEventKind>(event.trial().step()), event.scan());
  };
  std::ranges::for_each(events, add);
  using enum TrialEventKind;
  ASSERT_FALSE(steps.empty());
  const std::uint64_t go = steps[0].second;
  EXPECT_EQ(go, kBlock + 900) << "when a tick saw that it runs";
  pass(0.5, 0.3);
  pass(11.0, 0.7);
  std::ranges::for_each(taken_events(v1::Event::kTrial), add);
  EXPECT_THAT(steps, ElementsAre(std::pair{Ready, go}, std::pair{Go, go}, std::pair{Measure, go + 750}, std::pair{Done, go + 17'250},
                                 std::pair{Rest, go + 17'250}));
  EXPECT_EQ(events[0].trial().session_id(), now().session.id);
  EXPECT_EQ(now().trial->trial, 1U);
  ASSERT_EQ(device_->cues.size(), 2U);
  EXPECT_FALSE(device_->cues[0].is_go);
  EXPECT_TRUE(device_->cues[1].is_go);

  pass(1.5);
  ASSERT_TRUE(supervisor_->trial("floor", TrialAction::Next));
  static_cast<void>(taken_events(v1::Event::kTrial));
  pass(7.1, 7.1);  // so late that nobody knows what came in between
  const auto late = taken_events(v1::Event::kTrial);
  ASSERT_EQ(late.size(), 1U);
  EXPECT_EQ(late[0].scan(), rig().acquisition().next_scan - 1);
}

TEST_F(RigSessionTest, SessionStoppedBeforeItsFirstTrial_WantsNoTrialAnyMore) {
  start({standing()});
  ASSERT_TRUE(supervisor_->start_session("floor", {.protocol = "standing"}));
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  ASSERT_TRUE(now().trial && now().trial->is_next_wanted);
  ASSERT_TRUE(supervisor_->stop_session("floor", false, ""));
  ASSERT_TRUE(now().trial);
  EXPECT_FALSE(now().trial->is_next_wanted);
}

TEST_F(RigSessionTest, SessionWithoutAProtocol_IsRefusedWithTheList) {
  start({Protocol{}, standing(), Protocol{.name = "chair", .rig_kind = "chair"}});
  const auto refused = [&] { return why_refused(supervisor_->start_session("floor", {.protocol = ""}), ErrorCode::InvalidArgument); };
  EXPECT_EQ(refused(), "a session needs a protocol, and none is given; add --protocol NAME, one of: free, standing");
  static_cast<void>(record(10, {.protocol = "standing"}));
  ASSERT_TRUE(stop());
  EXPECT_THAT(refused(), testing::EndsWith("one of: free, standing; last used on rig 'floor': standing"));
}

TEST_F(RigSessionTest, RejectThatIsUndoneAfterTheTimeOfTheTrial_HasTheResultOfTheWholeTrial) {
  start({standing()});
  const std::string id = record(kBlock, {.protocol = "standing"});
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass(8.0);
  const auto rejected = supervisor_->trial("", TrialAction::Reject);
  ASSERT_TRUE(rejected);
  EXPECT_EQ(rejected->last_ended->outcome, TrialEventKind::Rejected);
  EXPECT_EQ(rejected->undo_s, 5.0);
  EXPECT_EQ(row(id).trials.at(0).outcome, "rejected");
  pass(4.0);
  const auto undone = supervisor_->trial("", TrialAction::Undo);
  ASSERT_TRUE(undone);
  EXPECT_EQ(undone->last_ended->outcome, TrialEventKind::Done);
  EXPECT_EQ(undone->phase, TrialPhase::Resting);
  ASSERT_TRUE(eventually([&] {
    supervisor_->tick();
    return !row(id).trials.empty() && !row(id).trials.at(0).result.empty();
  }));
  ASSERT_TRUE(stop());

  const record::TrialRow trial = row(id).trials.at(0);
  EXPECT_EQ(trial.outcome, "done");
  EXPECT_EQ(trial.last_scan - trial.first_scan, 16'500U);
  const auto recording = record::Recording::open(row(id).parts.at(0).file).value();
  const auto standing = read_recorded_standing(*recording, [](double) {}).value();
  ASSERT_EQ(standing.trials.size(), 1U);
  EXPECT_EQ(standing.trials[0].outcome, "done");
  ASSERT_TRUE(standing.trials[0].live && standing.trials[0].live->analysis);
  const auto again = posturography::analyse(standing.trials[0].cop, {.preparation = posturography::kReportPreparation});
  ASSERT_TRUE(again);
  EXPECT_EQ(again->measures, standing.trials[0].live->analysis->measures);
}

TEST_F(RigSessionTest, EventThatWasDueInAGap_IsAtTheFirstScanAfterIt) {
  start({standing()});
  static_cast<void>(record(kBlock, {.protocol = "standing"}));
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass(11.0);
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Reject)) << "0.5 s before the end of the trial";
  give({.outcome = device::ReadOutcome::Gap, .gap = {.reason = core::GapReason::Silence, .missing_scans = 1500}});
  clock_.advance_s(1.0);
  pass(1.0);
  static_cast<void>(taken_events(v1::Event::kTrial));
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Undo));

  const auto events = taken_events(v1::Event::kTrial);
  const auto done = std::ranges::find(events, v1::TRIAL_EVENT_KIND_DONE, [](const v1::Event& event) { return event.trial().step(); });
  ASSERT_NE(done, events.end());
  EXPECT_EQ(done->segment(), rig().acquisition().segment);
  EXPECT_EQ(done->scan(), 0U);
}

TEST_F(RigSessionTest, RejectThatIsUndoneUnderWay_LeavesTheCatalogueAsBefore) {
  start({standing()});
  const std::string id = record(kBlock, {.protocol = "standing"});
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass(2.0);
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Reject));
  ASSERT_EQ(row(id).trials.size(), 1U);
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Undo));
  EXPECT_TRUE(row(id).trials.empty()) << "it is under way";
  EXPECT_EQ(now().trial->phase, TrialPhase::Measuring);
  EXPECT_FALSE(now().trial->last_ended);
  ASSERT_TRUE(stop());
  EXPECT_EQ(row(id).trials.at(0).outcome, "aborted");
}

TEST_F(RigSessionTest, SessionStoppedDuringAnAnalysis_EndsWithTheResult) {
  for (const bool is_daemon_ending : {false, true}) {
    std::promise<void> go_on;
    const auto before = worker_.run([&] { go_on.get_future().wait(); });
    start({standing()});
    const std::string id = record(kBlock, {.protocol = "standing"});
    ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
    pass(13.0);
    EXPECT_TRUE(supervisor_->mark("floor", "commands are executed meanwhile"));
    ASSERT_TRUE(supervisor_->stop_session("floor"));
    pass(0.5);
    EXPECT_EQ(state(), SessionState::Stopping);
    EXPECT_EQ(row(id).trials.at(0).result, "");
    go_on.set_value();
    if (is_daemon_ending) {
      supervisor_->stop();
    } else {
      ASSERT_TRUE(is_in(SessionState::Idle));
    }
    EXPECT_EQ(row(id).state, "complete");
    EXPECT_THAT(row(id).trials.at(0).result, HasSubstr("MVELO"));
    EXPECT_FALSE(recordings_->catalogue().results(id).value().empty());
    EXPECT_EQ(taken_events(v1::Event::kSway).size(), 1U);
    if (!is_daemon_ending) end();
  }
}

TEST_F(RigSessionTest, RedoDuringAnAnalysisThatIsUndone_HasItsResultOnTheBus) {
  std::promise<void> go_on;
  const auto before = worker_.run([&] { go_on.get_future().wait(); });
  start({standing()});
  const std::string id = record(kBlock, {.protocol = "standing"});
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass(13.0);
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Redo));
  go_on.set_value();
  ASSERT_TRUE(eventually([&] {
    supervisor_->tick();
    return !row(id).trials.at(0).result.empty();
  }));
  EXPECT_TRUE(taken_events(v1::Event::kSway).empty()) << "the next attempt is shown";
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Undo));
  const auto sways = taken_events(v1::Event::kSway);
  ASSERT_EQ(sways.size(), 1U);
  EXPECT_EQ(sways[0].sway().trial(), 1U);
  ASSERT_TRUE(stop());
  EXPECT_TRUE(taken_events(v1::Event::kSway).empty()) << "once";
}

TEST_F(RigSessionTest, StandingTrials_HaveResultsInTheCatalogueAndFiguresAtTheEnd) {
  start({standing()});
  const std::string id = record(kBlock, {.protocol = "standing"});
  for (int trial = 0; trial < 2; ++trial) {
    ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
    pass(13.0);
  }
  auto sways = taken_events(v1::Event::kSway);
  ASSERT_TRUE(eventually([&] {  // the worker may need longer than the two trials did
    for (auto& sway : taken_events(v1::Event::kSway)) sways.push_back(std::move(sway));
    return sways.size() == 2;
  }));
  EXPECT_EQ(sways[0].sway().session_id() + " " + sways[0].sway().software(), id + " dtsd test");
  EXPECT_EQ(sways[1].sway().condition(), "closed");
  ASSERT_TRUE(stop());

  const auto trials = row(id).trials;
  ASSERT_EQ(trials.size(), 2U);
  for (const record::TrialRow& trial : trials) {
    EXPECT_EQ(trial.outcome, "done");
    EXPECT_EQ(trial.part, 1U);
    EXPECT_EQ(trial.last_scan - trial.first_scan, 16'500U);
    EXPECT_THAT(trial.result, HasSubstr("\"sway\":{"));
  }
  const auto results = recordings_->catalogue().results(id).value();
  std::set<std::string> names;
  for (const record::ResultRow& result : results) names.insert(result.name);
  EXPECT_THAT(names, testing::IsSupersetOf({"open/MVELO", "closed/MVELO", "romberg/MVELO"}));
  auto recording = record::Recording::open(row(id).parts.at(0).file).value();
  std::size_t figures = 0;
  while (const auto item = recording->next().value()) {
    const auto* event = std::get_if<record::TimedEvent>(&*item);
    figures += event != nullptr && event->event.has_figure() ? 1 : 0;
  }
  EXPECT_EQ(figures, results.size());
  EXPECT_THAT(why_refused(supervisor_->resume_session(id)), HasSubstr("there is nothing to resume"));
}

TEST_F(RigSessionTest, TrialInWhichTheSubjectSteppedOff_IsDoneAndNotValid) {
  RecordProperty("requirement", "SWAY-4");
  start({standing()});
  const std::string id = record(kBlock, {.protocol = "standing"});
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass(6.0);
  device_->is_empty = true;
  pass(2.0);
  device_->is_empty = false;
  pass(5.0);
  ASSERT_TRUE(eventually([&] { return taken_events(v1::Event::kSway).size() == 1; }));

  const EndedAttempt ended = now().trial->last_ended.value();
  EXPECT_EQ(ended.outcome, TrialEventKind::Done);
  EXPECT_EQ(ended.trial, 1U);
  EXPECT_EQ(ended.fault, v1::TRIAL_FAULT_STEPPED_OFF);
  ASSERT_TRUE(stop());
  EXPECT_EQ(row(id).parts.at(0).valid_trials, 0U);
  EXPECT_EQ(row(id).trials.at(0).outcome, "done");
  EXPECT_EQ(record::fault_of(*record::event_of_text(row(id).trials.at(0).result)), v1::TRIAL_FAULT_STEPPED_OFF);
  EXPECT_THAT(recordings_->catalogue().results(id).value(), testing::IsEmpty());
}

TEST_F(RigSessionTest, ResumedTrials_GoOnBehindThoseThatAreDone) {
  start({standing()});
  const std::string id = record(kBlock, {.protocol = "standing"});
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass(13.0);
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass(2.0);
  ASSERT_TRUE(stop());
  EXPECT_EQ(row(id).trials.at(1).outcome, "aborted");
  EXPECT_EQ(row(id).state, "complete");

  ASSERT_TRUE(supervisor_->resume_session(id)) << "trials are open";
  ASSERT_TRUE(is_in(SessionState::Running));
  EXPECT_EQ(now().trial->next_condition, "closed");
  EXPECT_EQ(now().part, 2U);
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass(13.0);
  ASSERT_TRUE(stop());
  const std::vector<record::TrialRow> trials = row(id).trials;
  EXPECT_EQ(trials.back().outcome, "done");
  EXPECT_EQ(trials.back().attempt, 2U) << "attempts continue through the parts";
  EXPECT_EQ(record::read_recording(row(id).parts.at(1).file)->trials.back().attempt, 2U);
  const auto results = recordings_->catalogue().results(id).value();
  EXPECT_TRUE(std::ranges::any_of(results, [](const record::ResultRow& each) { return each.name == "closed/MVELO_part_2"; }));
  EXPECT_THAT(why_refused(supervisor_->resume_session(id)), HasSubstr("there is nothing to resume"));
}

TEST_F(RigSessionTest, AttemptThatACrashInterrupted_KeepsItsNumber) {
  start({standing()});
  const std::string id = record(kBlock, {.protocol = "standing"});
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass(2.0);
  ASSERT_TRUE(eventually([&] {  // the record thread may be late
    const auto written = record::read_recording(row(id).parts.at(0).file);
    return written && !written->trials.empty();
  }));
  leave();
  start({standing()});
  ASSERT_TRUE(supervisor_->resume_session(id));
  ASSERT_TRUE(is_in(SessionState::Running));
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass(13.0);
  ASSERT_TRUE(stop());
  ASSERT_TRUE(eventually([&] { return row(id).parts.at(0).state == record::PartState::Recovered; }));
  std::string trials;
  for (const record::TrialRow& trial : row(id).trials) {
    trials += std::to_string(trial.part) + ":" + std::to_string(trial.trial) + "." + std::to_string(trial.attempt) + trial.outcome + " ";
  }
  EXPECT_EQ(trials, "1:1.1aborted 2:1.2done ");
}

TEST_F(RigSessionTest, CompleteSessionThatWasStoppedWithAReason_IsNotResumed) {
  start({standing()});
  const std::string id = record(kBlock, {.protocol = "standing"});
  for (int trial = 0; trial < 2; ++trial) {
    ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
    pass(13.0);
  }
  ASSERT_TRUE(stop(false, "the daemon was stopped"));
  EXPECT_EQ(row(id).state + " " + row(id).message, "complete the daemon was stopped");
  EXPECT_THAT(why_refused(supervisor_->resume_session(id)),
              AllOf(HasSubstr("session " + id + " is complete: all 2 trials are done"), HasSubstr("dtsctl session start --rig floor")));
}

TEST_F(RigSessionTest, ResumedSessionWithADuration_LastsForTheRestOfIt) {
  Protocol timed{.name = "timed", .settle_s = 1.0, .duration_s = 10.0, .definition = "v1"};
  start({Protocol{}, timed});
  const std::string id = record(kBlock, {.protocol = "timed"});
  pass(5.0);
  ASSERT_TRUE(stop(true, std::string(300, 'r')));
  EXPECT_EQ(row(id).message, std::string(200, 'r'));
  const double recorded_s = row(id).parts.at(0).duration_s;
  const auto resumed = supervisor_->resume_session(id);
  ASSERT_TRUE(resumed);
  EXPECT_NEAR(resumed->second.request.duration_s, 10.0 - (recorded_s - 1.0), 1e-9);
  EXPECT_EQ(resumed->second.request.settle_s, 1.0);
  pass(6.5);
  ASSERT_TRUE(stop(true));
  EXPECT_THAT(why_refused(supervisor_->resume_session(id)), HasSubstr("has less than 1 s left"));
  end();
  timed.definition = "v2";
  start({Protocol{}, timed});
  EXPECT_THAT(why_refused(supervisor_->resume_session(id)), HasSubstr("protocol 'timed' has changed since"));
}

TEST_F(RigSessionTest, RecordingThatBreaks_EndsItsSessionAndTheTrialInIt) {
  start({standing()});
  const std::string id = record(kBlock, {.protocol = "standing"});
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass(1.0);
  std::filesystem::rename(folder_ / "sessions" / (id + ".xdf.part"), folder_ / "elsewhere");

  ASSERT_TRUE(is_in(SessionState::Failed));

  EXPECT_THAT(now().session.message, AllOf(HasSubstr("the recording stopped: "), HasSubstr("was deleted or moved")));
  EXPECT_EQ(row(id).state, "incomplete");
  EXPECT_EQ(row(id).trials.at(0).outcome, "aborted");
  EXPECT_THAT(log(), HasSubstr("is incomplete: "));
}

TEST_F(RigSessionTest, DeviceAwayAtTheEnd_LeavesTheRecordingIncomplete) {
  start();
  const std::string id = record(300);
  device_->is_absent = true;
  give({.outcome = device::ReadOutcome::Gone});
  while (rig().acquisition().device == device::DeviceState::Streaming) std::this_thread::yield();
  is_running_ = false;

  ASSERT_TRUE(stop());

  EXPECT_EQ(row(id).state, "incomplete");
  EXPECT_THAT(row(id).parts.at(0).reason, HasSubstr("the device delivered nothing when the session ended: "));
}

}  // namespace
}  // namespace dts::session
