// SPDX-License-Identifier: Apache-2.0
#include <functional>
#include <mutex>

#include "ctl/doctor.h"
#include "ctl/recording_view.h"
#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

v1::SessionRecord interrupted_session() {
  v1::SessionRecord session;
  session.set_session_id("20261121T144525Z-floor-1");
  session.set_rig("floor");
  session.set_protocol("reaching");
  session.set_subject("P017");
  session.set_state("interrupted");
  session.set_started_utc_ns(1'795'272'325'000'000'000);
  v1::SessionPart& part = *session.add_parts();
  part.set_part(1);
  part.set_state(v1::PART_STATE_RECOVERED);
  part.set_file("/data/a.recovered.xdf");
  part.set_sha256("0123abcd");
  part.set_duration_s(61.0);
  part.set_lost_s_at_most(0.75);
  part.set_reason("no footer");
  part.set_valid_trials(3);
  v1::LossCount& loss = *part.add_losses();
  loss.set_reason(v1::GAP_REASON_RING_FULL);
  loss.set_gaps_total(1);
  loss.set_lost_scans_total(10'560);
  session.set_planned_trials(4);
  v1::TrialRecord& trial = *session.add_trials();
  trial.set_trial(1);
  trial.set_condition("120");
  trial.set_outcome("rejected");
  (*session.mutable_fields())["age_years"] = "52";
  return session;
}

v1::ProtocolInfo reaching() {
  v1::ProtocolInfo protocol;
  protocol.set_name("reaching");
  protocol.set_sentence("Reaching at targets");
  protocol.set_trials(30);
  protocol.add_conditions("120");
  v1::ProtocolField& field = *protocol.add_fields();
  field.set_name("arm_length_cm");
  field.set_is_required(true);
  field.set_minimum(30.0);
  field.set_maximum(100.0);
  v1::ProtocolField& shoes = *protocol.add_fields();
  shoes.set_name("heel_cm");
  shoes.set_minimum(0.5);
  shoes.set_maximum(12.25);
  v1::ProtocolField& side = *protocol.add_fields();
  side.set_name("side");
  for (const char* choice : {"left", "right"}) side.add_choices(choice);
  return protocol;
}

/// Remembers the request and answers as the daemon would.
class SessionCommandsTest : public RunTest {
 protected:
  std::vector<std::string> answer(const v1::Request& request) {
    const std::lock_guard lock(mutex_);
    request_ = request;
    return {testing::reply(request, [&](v1::Response& response) { fill(request, response); })};
  }
  void fill(const v1::Request& request, v1::Response& response) {
    switch (request.command_case()) {
      case v1::Request::kListSessions:
        response.mutable_sessions();
        if (has_sessions_) *response.mutable_sessions()->add_sessions() = shown();
        break;
      case v1::Request::kShowSession: *response.mutable_session_record() = shown(); break;
      case v1::Request::kListProtocols: *response.mutable_protocols()->add_protocols() = reaching(); break;
      case v1::Request::kTrial:
        response.mutable_trial()->set_phase(phase_);
        response.mutable_trial()->set_trial(3);
        response.mutable_trial()->set_of(30);
        response.mutable_trial()->set_condition("120");
        break;
      case v1::Request::kGetAudit:
        response.mutable_audit()->add_entries()->set_what("start_session");
        response.mutable_audit()->set_verified_entries(17);
        response.mutable_audit()->set_problem(audit_problem_);
        break;
      case v1::Request::kStatus: *response.mutable_status() = status_; break;
      default:
        response.mutable_session()->set_session_id("floor-1");
        response.mutable_session()->set_rig("floor");
        response.mutable_session()->set_state(v1::SESSION_STATE_IDLE);
        *response.mutable_session()->mutable_recording() = recording_;
    }
  }
  [[nodiscard]] v1::SessionRecord shown() const {
    v1::SessionRecord session = interrupted_session();
    show_(session);
    return session;
  }
  [[nodiscard]] v1::Request request() {
    const std::lock_guard lock(mutex_);
    return request_;
  }

  std::mutex mutex_;
  v1::Request request_;
  v1::RecordingStatus recording_;
  v1::StatusSnapshot status_ = testing::floor_status();
  std::string audit_problem_;
  bool has_sessions_ = true;
  std::function<void(v1::SessionRecord&)> show_ = [](v1::SessionRecord&) {};  ///< What is different in the session that is shown.
  v1::TrialPhase phase_ = v1::TRIAL_PHASE_READY;
  testing::FakeController daemon_{control_, [this](const v1::Request& asked, int) { return answer(asked); }};
};

TEST_F(SessionCommandsTest, Start_FieldsOfTheProtocolArrive) {
  EXPECT_EQ(run_with({"session", "start", "--rig", "floor", "--protocol", "reaching", "--subject", "P017", "--field", "arm_length_cm=71",
                      "--field", "side=left=right"}),
            cli::kOk);

  const v1::StartSessionRequest start = request().start_session();
  EXPECT_EQ(start.protocol(), "reaching");
  EXPECT_EQ(start.subject(), "P017");
  EXPECT_EQ(start.fields().at("arm_length_cm"), "71");
  EXPECT_EQ(start.fields().at("side"), "left=right");
}

TEST_F(SessionCommandsTest, StartWithAFieldTwiceOrWithoutValue_UsageErrorAndNothingIsStarted) {
  EXPECT_EQ(run_with({"session", "start", "--rig", "floor", "--field", "a=1", "--field", "a=2"}), cli::kUsage);
  EXPECT_THAT(talk(), HasSubstr("'a' is given twice"));
  for (const char* wrong : {"a", "=1", "a="}) {
    EXPECT_EQ(run_with({"session", "start", "--rig", "floor", "--field", wrong}), cli::kUsage) << wrong;
  }
  EXPECT_EQ(daemon_.requests(), 0);
}

TEST_F(SessionCommandsTest, Stop_SaysWhereItIsRecordedAndWhatIsMissing) {
  recording_.set_file("/data/a.xdf");
  recording_.set_bytes(12'345'678);
  recording_.set_problem("disk full");

  EXPECT_EQ(run_with({"session", "stop"}), cli::kOk);

  EXPECT_THAT(out(), HasSubstr("recorded 12.3 MB in /data/a.xdf\n"));
  EXPECT_THAT(out(), HasSubstr("the recording is incomplete: disk full"));
  EXPECT_FALSE(request().stop_session().is_abort());
}

TEST_F(SessionCommandsTest, AbortAndResume_CarryTheirArguments) {
  EXPECT_EQ(run_with({"session", "abort", "--rig", "floor", "--reason", "subject felt dizzy"}), cli::kOk);
  EXPECT_TRUE(request().stop_session().is_abort());
  EXPECT_EQ(request().stop_session().reason(), "subject felt dizzy");
  EXPECT_EQ(request().stop_session().rig(), "floor");

  EXPECT_EQ(run_with({"session", "resume", "floor-1"}), cli::kOk);
  EXPECT_EQ(request().resume_session().session_id(), "floor-1");
  EXPECT_EQ(out(), "floor-1\n");
}

TEST_F(SessionCommandsTest, List_ShowsEveryStateWithItsWord) {
  EXPECT_EQ(run_with({"session", "list", "--rig", "floor", "--subject", "P017", "--protocol", "reaching", "--limit", "5"}), cli::kOk);

  EXPECT_THAT(out(), HasSubstr("20261121T144525Z-floor-1"));
  EXPECT_THAT(out(), HasSubstr("3 of 4  interrupted (10560 scans lost in 1 gap)"));
  EXPECT_THAT(out(), HasSubstr("1 min 1 s"));
  EXPECT_EQ(request().list_sessions().rig(), "floor");
  EXPECT_EQ(request().list_sessions().subject(), "P017");
  EXPECT_EQ(request().list_sessions().protocol(), "reaching");
  EXPECT_EQ(request().list_sessions().limit(), 5U);
}

TEST_F(SessionCommandsTest, ListOfARigThatIsNotThere_ExitsWithFiveUnlessItHasSessions) {
  EXPECT_EQ(run_with({"session", "list", "--rig", "attic"}), cli::kOk) << "a rig of earlier days";

  has_sessions_ = false;
  EXPECT_EQ(run_with({"session", "list", "--rig", "flor"}), 5);
  EXPECT_THAT(talk(), HasSubstr("did you mean floor?"));
  EXPECT_EQ(run_with({"session", "list", "--rig", "floor"}), cli::kOk);
  EXPECT_EQ(out(), "no session\n");
}

TEST_F(SessionCommandsTest, StartOnARigThatDoesNotStream_SaysThatItWaits) {
  EXPECT_EQ(run_with({"session", "start", "--rig", "floor"}), cli::kOk);
  EXPECT_EQ(talk(), "");

  status_.mutable_rigs(0)->set_device(v1::DEVICE_STATE_WAITING);
  status_.mutable_rigs(0)->set_device_message("waits for its trigger");
  EXPECT_EQ(run_with({"session", "start", "--rig", "floor"}), cli::kOk);
  EXPECT_EQ(out(), "floor-1\n");
  EXPECT_EQ(talk(), "dtsctl: rig 'floor' waits: waits for its trigger; the session begins with the first scan\n");
}

TEST_F(SessionCommandsTest, LossesThatAreNotKnown_AreNotCalledNone) {
  show_ = [](v1::SessionRecord& session) {
    session.mutable_parts(0)->clear_losses();
    session.mutable_parts(0)->set_is_loss_unknown(true);
  };
  EXPECT_EQ(run_with({"session", "list"}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("interrupted (losses not known)"));
  EXPECT_EQ(run_with({"session", "show", "x"}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("part 1: losses not known"));
  EXPECT_EQ(run_with({"session", "show", "x", "--json"}), cli::kOk);
  const auto session = json();
  for (const auto& counted : {session, session.at("parts").at(0)}) {
    EXPECT_FALSE(counted.contains("lost_scans"));
    EXPECT_FALSE(counted.contains("gaps"));
  }
  EXPECT_FALSE(session.at("parts").at(0).contains("losses"));
}

TEST_F(SessionCommandsTest, TrialThatAGapDivides_IsPlacedBySegmentAndScan) {
  show_ = [](v1::SessionRecord& session) {
    session.mutable_trials(0)->set_first_scan(812);
    session.mutable_trials(0)->set_last_scan(912);
  };
  EXPECT_EQ(run_with({"session", "show", "x"}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("  812 .. 912"));
  show_ = [](v1::SessionRecord& session) {
    session.mutable_trials(0)->set_first_scan(812);
    session.mutable_trials(0)->set_last_scan(212);
    session.mutable_trials(0)->set_last_segment(1);
  };
  EXPECT_EQ(run_with({"session", "show", "x"}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("0:812 .. 1:212"));
}

TEST_F(SessionCommandsTest, ListJson_WhatIsNotKnownIsAbsent) {
  EXPECT_EQ(run_with({"session", "list", "--json"}), cli::kOk);

  const auto session = json().at("sessions").at(0);
  EXPECT_EQ(session.at("state"), "interrupted");
  EXPECT_EQ(session.at("parts").at(0).at("state"), "recovered");
  for (const auto& counted : {session, session.at("parts").at(0)}) {
    EXPECT_EQ(counted.at("lost_scans"), 10'560);
    EXPECT_EQ(counted.at("gaps"), 1);
    EXPECT_EQ(counted.at("valid_trials"), 3);
    EXPECT_EQ(counted.at("planned_trials"), 4);
  }
  EXPECT_FALSE(session.contains("ended_utc_ns"));
  EXPECT_FALSE(session.contains("label"));
}

TEST_F(SessionCommandsTest, Show_PartsReasonsAndTrials) {
  EXPECT_EQ(run_with({"session", "show", "20261121T144525Z-floor-1"}), cli::kOk);

  EXPECT_THAT(out(), HasSubstr("/data/a.recovered.xdf"));
  EXPECT_THAT(out(), HasSubstr("no footer; at most 0.75 s are lost"));
  EXPECT_THAT(out(), HasSubstr("part 1: SHA-256 0123abcd"));
  EXPECT_THAT(out(), HasSubstr("part 1: 10560 scans lost in 1 gap: ring_full 1"));
  EXPECT_THAT(out(), HasSubstr("3 of 4 trials valid"));
  EXPECT_THAT(out(), HasSubstr("rejected"));
  EXPECT_THAT(out(), HasSubstr("age_years   52\n"));
  EXPECT_EQ(request().show_session().session_id(), "20261121T144525Z-floor-1");
}

TEST_F(SessionCommandsTest, Trial_EveryActionHasItsWord) {
  const std::vector<std::pair<std::string, v1::TrialAction>> actions{
      {"next", v1::TRIAL_ACTION_NEXT}, {"redo", v1::TRIAL_ACTION_REDO}, {"reject", v1::TRIAL_ACTION_REJECT}};
  for (const auto& [word, action] : actions) {
    EXPECT_EQ(run_with({"session", "trial", word, "--rig", "floor"}), cli::kOk);
    EXPECT_EQ(request().trial().action(), action) << word;
    EXPECT_EQ(request().trial().rig(), "floor");
  }
  EXPECT_EQ(out(), "trial 3 of 30, ready: 120\n");
  EXPECT_EQ(run_with({"session", "trial", "skip"}), cli::kUsage);
}

TEST_F(SessionCommandsTest, NextBeforeTheSessionRuns_SaysThatItWillStart) {
  phase_ = v1::TRIAL_PHASE_WAITING;

  EXPECT_EQ(run_with({"session", "trial", "next"}), cli::kOk);

  EXPECT_THAT(out(), ::testing::StartsWith("starts as soon as the session runs: "));
}

TEST(TrialLine, AllDone_SaysHowToEndTheSession) {
  v1::TrialStatus trial;
  trial.set_phase(v1::TRIAL_PHASE_FINISHED);
  trial.set_of(9);

  EXPECT_EQ(trial_line(trial, "chair"), "all 9 trials are done; end the session: dtsctl session stop --rig chair");
  trial.set_of(1);
  EXPECT_EQ(trial_line(trial, ""), "the trial is done; end the session: dtsctl session stop");
}

TEST_F(SessionCommandsTest, Protocols_AreListedAndShown) {
  EXPECT_EQ(run_with({"protocol", "list"}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("Reaching at targets"));

  EXPECT_EQ(run_with({"protocol", "show", "reaching"}), cli::kOk);
  EXPECT_THAT(out(), HasSubstr("arm_length_cm"));
  EXPECT_THAT(out(), HasSubstr("30 .. 100"));
  EXPECT_THAT(out(), HasSubstr("0.5 .. 12.25"));
  EXPECT_THAT(out(), HasSubstr("left or right"));

  EXPECT_EQ(run_with({"protocol", "show", "reachin"}), 5);
  EXPECT_THAT(talk(), HasSubstr("did you mean reaching?"));
}

TEST_F(SessionCommandsTest, Audit_UnbrokenChainExitsWithZero) {
  EXPECT_EQ(run_with({"audit", "--limit", "3"}), cli::kOk);

  EXPECT_THAT(out(), HasSubstr("start_session"));
  EXPECT_THAT(out(), HasSubstr("17 entries, the chain holds"));
  EXPECT_EQ(request().get_audit().limit(), 3U);
}

TEST_F(SessionCommandsTest, Audit_BrokenChainExitsWithSevenAndShowsWhatThereIs) {
  audit_problem_ = "entry 9 does not fit";

  EXPECT_EQ(run_with({"audit"}), 7);
  EXPECT_THAT(out(), HasSubstr("start_session"));
  EXPECT_THAT(out(), Not(HasSubstr("holds")));
  EXPECT_THAT(talk(), HasSubstr("entry 9 does not fit"));

  EXPECT_EQ(run_with({"audit", "--json"}), 7);
  EXPECT_EQ(json().at("problem"), "entry 9 does not fit");
}

TEST_F(SessionCommandsTest, Status_ShowsRecordingTrialAndDisk) {
  v1::SessionInfo& session = *status_.mutable_rigs(0)->mutable_session();
  session.set_session_id("floor-1");
  session.set_state(v1::SESSION_STATE_RUNNING);
  session.mutable_recording()->set_is_recording(true);
  session.mutable_recording()->set_part(2);
  session.mutable_recording()->set_file("/data/a.2.xdf.part");
  session.mutable_recording()->set_bytes(999);
  session.mutable_recording()->set_lost_scans_total(4);
  session.mutable_trial()->set_phase(v1::TRIAL_PHASE_RESTING);
  session.mutable_trial()->set_trial(2);
  session.mutable_trial()->set_of(9);
  session.mutable_trial()->set_next_condition("150");
  session.mutable_trial()->set_next_target_cm(85.25);
  status_.mutable_disk()->set_state(v1::DISK_STATE_LOW);
  status_.mutable_disk()->set_free_bytes(2'000'000'000);
  status_.mutable_disk()->set_recordable_s(3600.0);

  EXPECT_EQ(run_with({"status"}), cli::kOk);

  EXPECT_THAT(out(), HasSubstr("floor: recording part 2, 999 B in /data/a.2.xdf.part"));
  EXPECT_THAT(out(), HasSubstr("4 scans did not reach the file"));
  EXPECT_THAT(out(), HasSubstr("trial 2 of 9, resting; next 150 at 85.2 cm"));
  EXPECT_THAT(out(), HasSubstr("disk: 2.0 GB free, room for 1 h 0 min, low"));
}

TEST_F(SessionCommandsTest, NobodyThere_FileCommandsStillSayWhatAnIdNeeds) {
  EXPECT_EQ(run_bare({"session", "verify", "floor-1", "--endpoint", directory_.endpoint("nobody.sock")}), 3);
}

TEST(BytesText, UnitsChangeAtThousands) {
  EXPECT_EQ(bytes_text(0), "0 B");
  EXPECT_EQ(bytes_text(999), "999 B");
  EXPECT_EQ(bytes_text(1000), "1.0 kB");
  EXPECT_EQ(bytes_text(999'960), "1.0 MB");
  EXPECT_EQ(bytes_text(std::numeric_limits<std::uint64_t>::max()), "18446744.1 TB");
}

TEST(UtcText, KnownInstants) {
  EXPECT_EQ(utc_text(0), "-");
  EXPECT_EQ(utc_text(1'709'210'096'999'999'999), "2024-02-29 12:34:56");
}

TEST(DoctorDisk, OnlyAFineDiskIsWell) {
  v1::DiskStatus disk;
  EXPECT_TRUE(check_disk(disk).empty()) << "a daemon that records nothing";
  disk.set_state(v1::DISK_STATE_FINE);
  EXPECT_TRUE(check_disk(disk).at(0).is_good);
  for (const auto state : {v1::DISK_STATE_LOW, v1::DISK_STATE_FULL, v1::DISK_STATE_UNUSABLE}) {
    disk.set_state(state);
    EXPECT_FALSE(check_disk(disk).at(0).is_good);
    EXPECT_FALSE(check_disk(disk).at(0).fix.empty());
  }
}

}  // namespace
}  // namespace dts::ctl
