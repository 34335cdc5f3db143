// SPDX-License-Identifier: Apache-2.0
// Sessions of a real rig (simulated floor, real threads) with their recordings, catalogue and recovery.
#include "session/recordings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <unistd.h>

#include <array>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <utility>

#include "dts/wire/options.h"
#include "record/recording.h"
#include "record/xdf/recovery.h"
#include "recordings_fixture.h"

namespace dts::session {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST_F(RecordingsTest, Session_IsOnTheDiskFromItsStartAndWholeAtItsEnd) {
  start();
  const std::string id = record(600, {.subject = "P017", .label = "first"});
  EXPECT_TRUE(std::filesystem::exists(folder_ / "sessions" / (id + ".xdf.part")));

  ASSERT_TRUE(stop());

  const record::SessionRow session = row(id);
  EXPECT_EQ(session.state, "complete");
  ASSERT_EQ(session.parts.size(), 1U);
  EXPECT_EQ(session.parts[0].state, record::PartState::Complete);
  const auto verified = record::verify(session.parts[0].file).value();
  EXPECT_EQ(verified.sha256, session.parts[0].sha256);
  EXPECT_TRUE(verified.is_closed);
  EXPECT_GE(verified.scans, 600U);
  const auto facts = record::Recording::open(session.parts[0].file).value()->session().value();
  EXPECT_EQ(facts.subject, "P017");
  EXPECT_THAT(facts.stages, testing::Contains(HasSubstr("window_filter")));
}

TEST_F(RecordingsTest, StoppedSessionWhoseFileIsStillOpen_IsListedAsRunning) {
  start();
  std::string earlier;
  for (const bool is_abort : {false, true}) {
    const std::string id = record(100);
    if (!earlier.empty()) {
      EXPECT_EQ(recordings_->corrected(row(earlier)), row(earlier)) << "not the one that is recorded";
    }
    earlier = id;

    ASSERT_TRUE(supervisor_->stop_session("floor", is_abort, "a test"));
    // Only a tick enters the end of the file, and this thread is the one that ticks.
    const record::SessionRow at_once = recordings_->corrected(row(id));
    ASSERT_TRUE(is_in(SessionState::Idle));

    EXPECT_EQ(at_once.state, "running");
    EXPECT_EQ(at_once.message, "");
    EXPECT_EQ(at_once.ended_utc_ns, 0);
    EXPECT_EQ(recordings_->corrected(row(id)).state, is_abort ? "aborted" : "complete");
  }
}

TEST_F(RecordingsTest, MarksAndStates_StandInTheFile) {
  start();
  const std::string id = record(200, {.subject = "P017", .label = "Jane Doe"});
  const auto marks = supervisor_->mark("floor", "eyes closed").value();
  ASSERT_TRUE(stop());

  auto recording = record::Recording::open(row(id).parts[0].file).value();
  std::vector<std::string> states;
  std::optional<record::TimedEvent> mark;
  double first_s = 0.0;
  while (auto item = recording->next().value()) {
    if (auto* scans = std::get_if<record::RecordedScans>(&*item); scans != nullptr && first_s == 0.0) {
      first_s = scans->first_time_s - static_cast<double>(scans->first_scan.value) / 1500.0;
    }
    auto* event = std::get_if<record::TimedEvent>(&*item);
    if (event != nullptr && event->event.has_session()) {
      const v1::SessionChange& change = event->event.session();
      states.push_back(wire::enumerator_word(*v1::SessionState_descriptor(), change.state()));
      EXPECT_EQ(change.subject() + change.label(), "") << "exports of the events must not name the person";
    }
    if (event != nullptr && event->event.has_marker()) mark = *event;
  }

  EXPECT_THAT(states, ElementsAre("starting", "settling", "running", "stopping"));
  ASSERT_TRUE(mark);
  EXPECT_EQ(mark->event.scan(), marks[0].at.scan.value);
  EXPECT_NEAR(mark->time_s, first_s + static_cast<double>(mark->event.scan()) / 1500.0, 1e-8);
}

TEST_F(RecordingsTest, DaemonDies_TheNextOneListsAndRecoversWhatItWrote) {
  start();
  const std::string id = record(1500);
  leave();

  start();
  EXPECT_EQ(row(id).state, "interrupted");
  ASSERT_TRUE(is_recovered(id));

  const record::PartRow part = row(id).parts.at(0);
  EXPECT_GT(part.lost_s_at_most, 0.0);
  EXPECT_LE(part.lost_s_at_most, 1.0);
  const auto verified = record::verify(part.file).value();
  EXPECT_EQ(verified.sha256, part.sha256);
  EXPECT_EQ(verified.scans, part.scans);
  EXPECT_EQ(std::filesystem::file_size(part.file), part.bytes);
  EXPECT_GE(row(id).ended_utc_ns - row(id).started_utc_ns, static_cast<std::int64_t>(part.duration_s * 1e9));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "sessions" / (id + ".xdf.part"))) << "the original stays";
  end();
  open();
  std::vector<std::string> trail;
  const auto audit = recordings_->catalogue().audit(10).value();
  for (const record::AuditEntry& entry : audit) trail.push_back(entry.what + " " + entry.target);
  EXPECT_THAT(trail, ElementsAre("start ", "interrupted " + id, "start ", "recover " + id, "stop "));
}

TEST_F(RecordingsTest, DaemonDiesBeforeTheFirstScanIsWritten_TheSessionWasInterrupted) {
  start();
  const std::string id = record(50);
  leave();
  const std::string part = (folder_ / "sessions" / (id + ".xdf.part")).string();
  std::ifstream file(part, std::ios::binary);
  const std::string whole(std::istreambuf_iterator<char>(file), {});
  const std::string_view header_end = "</info>";
  std::filesystem::resize_file(part, whole.find(header_end) + header_end.size());

  start();
  ASSERT_TRUE(is_recovered(id));

  EXPECT_EQ(row(id).state, "interrupted");
}

TEST_F(RecordingsTest, TrialWhoseEndWasLost_DoesNotCountAfterRecovery) {
  Protocol protocol{.name = "steps", .trials = TrialPlan{}};
  protocol.trials->conditions = {{.name = "open"}, {.name = "closed"}};
  protocol.trials->trials_per_block = 2;
  start({Protocol{}, protocol});
  const std::string id = record(50, {.protocol = "steps"});
  ASSERT_TRUE(is_in(SessionState::Running));
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  const std::string part = (folder_ / "sessions" / (id + ".xdf.part")).string();
  ASSERT_TRUE(eventually([&] {
    std::ifstream file(part, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {}).find("TRIAL_EVENT_KIND_MEASURE") != std::string::npos;
  }));
  const auto kept = std::filesystem::file_size(part);
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));  // done: the catalogue knows at once, the file a moment later
  ASSERT_EQ(row(id).trials.at(0).outcome, "done");
  leave();
  std::filesystem::resize_file(part, kept);

  start({Protocol{}, protocol});
  ASSERT_TRUE(is_recovered(id));

  EXPECT_EQ(row(id).trials.at(0).outcome, "aborted");
}

TEST_F(RecordingsTest, NoRoomForACopy_TheInterruptedPartWaitsForIt) {
  constexpr std::uintmax_t kMebibyte = 1U << 20U;
  start();
  const std::string id = record(300);
  leave();
  const std::filesystem::path part = folder_ / "sessions" / (id + ".xdf.part");
  std::filesystem::resize_file(part, 100 * kMebibyte);  // a hole of zeros
  const double free_mib = static_cast<double>(std::filesystem::space(folder_).available) / kMebibyte;

  storage_.stop_below_mib = free_mib - 50.0;
  start();
  ASSERT_TRUE(eventually([&] { return row(id).parts.at(0).reason.find("no room") != std::string::npos; }));
  EXPECT_EQ(row(id).parts.at(0).state, record::PartState::Interrupted);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "sessions" / (id + ".recovered.xdf")));
  end();

  storage_.stop_below_mib = free_mib - 150.0;
  start();
  EXPECT_TRUE(is_recovered(id));
}

TEST_F(RecordingsTest, DaemonDiesBeforeTheEndOfASessionIsEntered_ItsPartSaysHowItEnded) {
  for (const auto& [state, reason] : {std::pair{"complete", ""}, std::pair{"incomplete", "why"}}) {
    start();
    const std::string id = record(1500);
    ASSERT_TRUE(stop());
    end();
    sqlite3* catalogue = nullptr;
    ASSERT_EQ(sqlite3_open((folder_ / "catalogue.sqlite").c_str(), &catalogue), SQLITE_OK);
    const std::string part_state =
        std::to_string(static_cast<int>(*reason == '\0' ? record::PartState::Complete : record::PartState::Incomplete));
    const std::string sql = "UPDATE sessions SET state = 'running', ended_utc_ns = 0 WHERE id = '" + id +
                            "'; UPDATE parts SET state = " + part_state + ", reason = '" + reason + "' WHERE session_id = '" + id + "'";
    ASSERT_EQ(sqlite3_exec(catalogue, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(catalogue);
    sqlite3_close(catalogue);

    open();
    EXPECT_EQ(row(id).state, state);
    EXPECT_EQ(row(id).message, reason);
    EXPECT_NEAR(static_cast<double>(row(id).ended_utc_ns - row(id).parts[0].started_utc_ns) * 1e-9, row(id).parts[0].duration_s, 1e-6);
    EXPECT_NE(recordings_->catalogue().audit(1).value().at(0).what, "interrupted");
    end();
  }
}

TEST_F(RecordingsTest, Resume_PassesOverAPartWhoseFileIsGone) {
  start();
  const std::string id = record(100, {.subject = "P1"});
  ASSERT_TRUE(stop(true));
  ASSERT_TRUE(supervisor_->resume_session(id));
  ASSERT_TRUE(is_in(SessionState::Running));
  ASSERT_TRUE(stop(true));
  std::filesystem::remove(row(id).parts.at(1).file);

  const auto resumed = supervisor_->resume_session(id);

  ASSERT_TRUE(resumed) << resumed.error().what;
  EXPECT_EQ(resumed->second.request.subject, "P1");
  EXPECT_EQ(row(id).parts.size(), 3U);
}

TEST_F(RecordingsTest, IdUsedByAnEarlierDaemon_IsNotUsedAgain) {
  start();
  const std::int64_t now_s = (clock_.now_ns() + clock_.utc_minus_monotonic_ns()) / 1'000'000'000;
  for (std::int64_t second = now_s; second < now_s + 30; ++second) {
    const auto stamp = static_cast<std::time_t>(second);
    std::array<char, 32> text{};
    std::tm utc{};
    std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%SZ-floor-1", gmtime_r(&stamp, &utc));
    ASSERT_TRUE(recordings_->catalogue().begin_part({.session_id = text.data(), .rig = "floor"}, "elsewhere.xdf"));
  }

  const auto started = supervisor_->start_session("floor", {});

  ASSERT_TRUE(started) << started.error().what;
  EXPECT_THAT(started->id, testing::EndsWith("-floor-2"));
}

TEST_F(RecordingsTest, AuditTrailOfAnotherCatalogue_IsToldAtTheStart) {
  start();
  recordings_->enter_audit({.utc_ns = 1, .who = "local", .what = "mark", .target = "floor", .result = "ok"});
  end();
  for (const char* ending : {"", "-wal", "-shm"}) std::filesystem::remove(folder_.string() + "/catalogue.sqlite" + ending);

  const auto opened = Recordings::open(storage_, clock_, log_);

  ASSERT_TRUE(opened);
  EXPECT_THAT(said_.str(), HasSubstr("audit trail: entry 1"));
}

TEST_F(RecordingsTest, CatalogueThatRefuses_LeavesNoFileBehind) {
  Protocol huge{.name = "huge"};
  huge.definition.assign(std::size_t{5} << 20U, ' ');  // more than the catalogue takes, less than a recording does
  start({Protocol{}, huge});

  EXPECT_FALSE(supervisor_->start_session("floor", {.protocol = "huge"}));

  EXPECT_EQ(state(), SessionState::Idle);
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "sessions"));
}

TEST_F(RecordingsTest, StoppedAtOnce_IsClosedThoughThePipelineNeverSawItBegin) {
  start();
  for (int round = 0; round < 5; ++round) {
    const auto started = supervisor_->start_session("floor", {});
    ASSERT_TRUE(started) << started.error().what;
    ASSERT_TRUE(supervisor_->stop_session("floor"));
    ASSERT_TRUE(eventually([&] { return state() != SessionState::Stopping; }));
    EXPECT_FALSE(row(started->id).state == "running");
  }
}

TEST_F(RecordingsTest, StoppedByTheDaemon_CanBeResumed) {
  start();
  const std::string id = record(100);
  end();

  start();
  EXPECT_EQ(row(id).state, "complete");
  EXPECT_THAT(row(id).message, HasSubstr("the daemon was stopped"));
  EXPECT_TRUE(supervisor_->resume_session(id));
}

TEST_F(RecordingsTest, NoRoom_NoSessionStarts) {
  storage_.refuse_below_min = storage_.warn_below_min = 1e12;
  start();

  const auto started = supervisor_->start_session("floor", {});

  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().code, core::ErrorCode::LimitExceeded);
  EXPECT_FALSE(state() == SessionState::Starting);
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "sessions"));
}

TEST_F(RecordingsTest, DiskNearlyFull_ClosesInOrderWhileTheStreamGoesOn) {
  RecordProperty("requirement", "SES-4");
  storage_.stop_below_mib = 1e9;  // more than any disk has
  start();
  const auto started = supervisor_->start_session("floor", {});
  ASSERT_TRUE(started) << "nobody asked for any room";
  ASSERT_TRUE(is_in(SessionState::Failed));
  EXPECT_EQ(row(started->id).state, "incomplete");
  EXPECT_EQ(row(started->id).parts.at(0).reason, "the disk is nearly full");
  feed(kBlock);
}

TEST_F(RecordingsTest, Trials_StandInTheCatalogueWithTheirScans) {
  Protocol protocol{.name = "steps", .trials = TrialPlan{}};
  protocol.trials->conditions = {{.name = "open"}, {.name = "closed"}};
  protocol.trials->trials_per_block = 2;
  start({Protocol{}, protocol});
  const std::string id = record(50, {.protocol = "steps"});
  ASSERT_TRUE(is_in(SessionState::Running));

  for (const TrialAction action : {TrialAction::Next, TrialAction::Next, TrialAction::Redo, TrialAction::Next}) {
    const auto stepped = supervisor_->trial("", action);
    ASSERT_TRUE(stepped) << stepped.error().what;
    feed(60);
  }
  ASSERT_TRUE(stop());

  std::vector<std::string> outcomes;
  for (const record::TrialRow& trial : row(id).trials) {
    outcomes.push_back(std::to_string(trial.trial) + "." + std::to_string(trial.attempt) + " " + trial.condition + " " + trial.outcome);
    EXPECT_GT(trial.last_scan, trial.first_scan);
  }
  EXPECT_THAT(outcomes, ElementsAre("1.1 open redone", "1.2 open done"));
}

}  // namespace
}  // namespace dts::session
