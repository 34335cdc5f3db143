// SPDX-License-Identifier: Apache-2.0
// Correcting, deleting and erasing closed sessions.
#include <gmock/gmock.h>
#include <sqlite3.h>

#include <fstream>
#include <map>
#include <thread>

#include "record/recording.h"
#include "session/correction_request.h"
#include "supervisor_fixture.h"

namespace dts::session {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr const char* kAnna = "local:anna";

class EditTest : public SupervisorTest {
 protected:
  /// A session of quiet standing with two trials that are done.
  std::string stand(const std::string& subject = "P071") {
    const std::string id = record(kBlock, {.protocol = "standing", .subject = subject, .label = "first"});
    for (int trial = 0; trial < 2; ++trial) {
      EXPECT_TRUE(supervisor_->trial("", TrialAction::Next));
      pass(13.0);
    }
    EXPECT_TRUE(stop());
    return id;
  }
  /// A session without trials.
  std::string brief(const std::string& subject) {
    const std::string id = record(kBlock, {.subject = subject});
    EXPECT_TRUE(stop());
    return id;
  }
  [[nodiscard]] std::map<std::string, double> results(const std::string& id) {
    std::map<std::string, double> values;
    const auto rows = recordings_->catalogue().results(id).value();
    for (const record::ResultRow& result : rows) values[result.name] = result.value;
    return values;
  }
  [[nodiscard]] std::string corrections_file(const std::string& id) const {
    return (folder_ / "sessions" / (id + ".corrections.json")).string();
  }
  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "sessions")) names.push_back(entry.path().filename().string());
    std::ranges::sort(names);
    return names;
  }
  [[nodiscard]] std::optional<record::Erased> erased() {
    std::optional<core::Result<record::Erased>> done;
    EXPECT_TRUE(eventually([&] {
      done = recordings_->take_erased();
      return done.has_value();
    }));
    EXPECT_TRUE(done && *done);
    return done && *done ? std::optional(**done) : std::nullopt;
  }
  [[nodiscard]] std::vector<std::string> listed() {
    std::vector<std::string> ids;
    const auto sessions = recordings_->catalogue().sessions({.shown = record::Shown::Both}).value();
    for (const record::SessionRow& session : sessions) ids.push_back(session.id);
    return ids;
  }
  /// Changes the catalogue as another program does.
  void change_catalogue(const std::string& sql) const {
    sqlite3* other = nullptr;
    EXPECT_EQ(sqlite3_open((folder_ / "catalogue.sqlite").c_str(), &other), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(other, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
    EXPECT_EQ(sqlite3_close(other), SQLITE_OK);
  }
  /// Returns whether no erasure is under way, or ends.
  [[nodiscard]] bool is_completed() {
    return eventually([this] { return !std::filesystem::exists(folder_ / "erasure.json"); });
  }
  [[nodiscard]] std::vector<record::AuditEntry> erasures_in_audit() {
    auto trail = recordings_->catalogue().audit(1000).value();
    std::erase_if(trail, [](const record::AuditEntry& entry) { return entry.what != "erase_subject"; });
    return trail;
  }
  /// Starts the daemon again with the files as they are.
  void restart() {
    end();
    start({Protocol{}, standing()});
  }
};

TEST_F(EditTest, ACorrectionChangesTheSession_AndNotTheRecording) {
  RecordProperty("requirement", "SES-9");
  start({Protocol{}, standing()});
  const std::string id = brief("P071");
  const std::string sha256 = row(id).parts.at(0).sha256;
  const auto corrected = supervisor_->correct_session(
      {.session_id = id, .subject = "P017", .label = "eyes closed", .notes = "new shoes", .reason = "typing error"}, kAnna);
  ASSERT_TRUE(corrected) << corrected.error().what;
  EXPECT_EQ(corrected->subject + " " + corrected->label + " " + corrected->notes, "P017 eyes closed new shoes");
  ASSERT_EQ(corrected->corrections.size(), 3U);
  const record::Correction& first = corrected->corrections[0];
  EXPECT_EQ(first.who + " " + first.old_value + " " + first.new_value + " " + first.reason, "local:anna P071 P017 typing error");
  EXPECT_EQ(first.utc_ns, clock_.now_ns() + clock_.utc_minus_monotonic_ns());
  EXPECT_EQ(now().session.request.subject, "P017") << "the status shows the last session";
  EXPECT_EQ(record::read_session_facts(row(id).parts.at(0).file)->subject, "P071");
  EXPECT_EQ(record::verify(row(id).parts.at(0).file)->sha256, sha256);
  EXPECT_THAT(why_refused(supervisor_->resume_session(id)), HasSubstr("corrected subject ID"));
}

TEST_F(EditTest, ResultsFollowTheOutcomesOfTheTrials) {
  start({Protocol{}, standing()});
  const std::string id = stand();
  const auto before = results(id);
  ASSERT_TRUE(before.contains("romberg/MVELO"));
  ASSERT_TRUE(supervisor_->correct_session({.session_id = id, .trial = 2, .outcome = "rejected", .reason = "talked"}, kAnna));
  auto after = results(id);
  EXPECT_TRUE(after.contains("open/MVELO"));
  EXPECT_FALSE(after.contains("closed/MVELO"));
  EXPECT_FALSE(after.contains("romberg/MVELO"));
  EXPECT_EQ(after.at("open/MVELO"), before.at("open/MVELO"));
  EXPECT_EQ(row(id).parts.at(0).valid_trials, 1U);
  EXPECT_EQ(row(id).trials.at(1).outcome + " " + row(id).trials.at(1).recorded_outcome, "rejected done");
  ASSERT_TRUE(supervisor_->correct_session({.session_id = id, .trial = 2, .attempt = 1, .outcome = "done", .reason = "did not"}, kAnna));
  EXPECT_EQ(results(id), before) << "to the last bit";
  EXPECT_EQ(row(id).parts.at(0).valid_trials, 2U);
}

TEST_F(EditTest, CorrectionsSurviveTheLossOfTheCatalogue) {
  RecordProperty("requirement", "REC-10");
  start({Protocol{}, standing()});
  const std::string id = stand();
  ASSERT_TRUE(
      supervisor_->correct_session({.session_id = id, .subject = "P017", .trial = 2, .outcome = "rejected", .reason = "talked"}, kAnna));
  const auto before = row(id);
  const auto figures = results(id);
  end();
  for (const char* name : {"catalogue.sqlite", "catalogue.sqlite-wal", "catalogue.sqlite-shm", "catalogue.sqlite.audit"})
    std::filesystem::remove(folder_ / name);

  start({Protocol{}, standing()});

  EXPECT_EQ(row(id).corrections, before.corrections);
  EXPECT_EQ(row(id).subject + " " + row(id).recorded_subject, "P017 P071");
  EXPECT_EQ(row(id).trials, before.trials);
  EXPECT_EQ(results(id), figures);
}

TEST_F(EditTest, ACorrectionsFileThatIsMissingIsWrittenAgain_AndABadOneIsKept) {
  start({Protocol{}, standing()});
  const std::string id = brief("P071");
  ASSERT_TRUE(supervisor_->correct_session({.session_id = id, .subject = "P017", .reason = "typing error"}, kAnna));
  std::filesystem::remove(corrections_file(id));
  restart();
  EXPECT_EQ(record::read_corrections(corrections_file(id))->all.size(), 1U);

  std::ofstream(corrections_file(id)) << "damaged";
  restart();
  EXPECT_THAT(log(), HasSubstr("corrections in '" + corrections_file(id) + "' cannot be read"));
  EXPECT_EQ(row(id).subject, "P017") << "the catalogue still has it";
  std::string text;
  std::getline(std::ifstream(corrections_file(id)), text);
  EXPECT_EQ(text, "damaged");
}

TEST_F(EditTest, AMarkerIsCorrectedAndRemoved_AlsoAfterTheLossOfTheCatalogue) {
  start({Protocol{}, standing()});
  ASSERT_TRUE(supervisor_->mark("", "before the session"));
  const std::string id = record(kBlock, {.subject = "P071"});
  for (const char* text : {"cough", "Anna fell"}) ASSERT_TRUE(supervisor_->mark("", text));
  ASSERT_TRUE(stop(true));
  ASSERT_TRUE(supervisor_->resume_session(id));
  ASSERT_TRUE(is_in(SessionState::Running));
  ASSERT_TRUE(supervisor_->mark("", "stumbled"));
  ASSERT_TRUE(stop());
  const auto markers = [&] {
    std::string text;
    const record::SessionRow session = row(id);
    for (const record::MarkerRow& one : session.markers) {
      text += std::to_string(one.part) + "." + std::to_string(one.number) + " " + one.text + " (" + one.recorded_text + "), ";
    }
    return text;
  };
  EXPECT_EQ(markers(), "1.1 cough (), 1.2 Anna fell (), 2.1 stumbled (), ");
  ASSERT_TRUE(supervisor_->correct_session({.session_id = id, .marker = 2, .marker_text = "", .reason = "had a name"}, kAnna));
  ASSERT_TRUE(supervisor_->correct_session({.session_id = id, .marker = 3, .marker_text = "fell", .reason = "seen later"}, kAnna));
  const std::string corrected = "1.1 cough (), 1.2  (), 2.1 fell (stumbled), ";
  EXPECT_EQ(markers(), corrected);
  const auto why = [&](CorrectionRequest request, core::ErrorCode code) {
    request.session_id = id;
    request.reason = "r";
    return why_refused(supervisor_->correct_session(request, kAnna), code);
  };
  EXPECT_THAT(why({.marker = 4, .marker_text = "x"}, core::ErrorCode::NotFound), HasSubstr("has no marker 4"));
  EXPECT_THAT(why({.marker = 1}, core::ErrorCode::InvalidArgument), HasSubstr("both its number and its text"));
  EXPECT_THAT(why({.marker_text = "x"}, core::ErrorCode::InvalidArgument), HasSubstr("both its number and its text"));
  EXPECT_THAT(why({.marker = 1, .marker_text = "cough"}, core::ErrorCode::InvalidArgument), HasSubstr("nothing to correct"));
  EXPECT_THAT(why({.marker = 1, .marker_text = std::string(201, 'x')}, core::ErrorCode::InvalidArgument), HasSubstr("more than 200"));
  end();
  for (const char* name : {"catalogue.sqlite", "catalogue.sqlite-wal", "catalogue.sqlite-shm", "catalogue.sqlite.audit"})
    std::filesystem::remove(folder_ / name);
  start({Protocol{}, standing()});
  EXPECT_EQ(markers(), corrected);
}

TEST_F(EditTest, AnErasureReportsMarkersOfOtherSessionsWithTheSubject) {
  start({Protocol{}, standing()});
  static_cast<void>(brief("P071"));
  const std::string other = record(kBlock, {.subject = "P018"});
  for (const char* text : {"cough", "P071 came in", "P071 left"}) ASSERT_TRUE(supervisor_->mark("", text));
  ASSERT_TRUE(stop());
  EXPECT_THAT(recordings_->sessions_mentioning("P071")->sessions, ElementsAre(other));
  ASSERT_TRUE(supervisor_->erase_subject("P071", kAnna));
  const auto removed = erased();
  ASSERT_TRUE(removed);
  EXPECT_THAT(removed->left, ElementsAre("the recordings of session " + other +
                                         " have this subject ID in marker 2 and in 1 more: remove the text (dtsctl session edit " + other +
                                         " --marker 2 --remove --reason TEXT), so that lists and exports do not show it; the recordings "
                                         "keep it"));
  for (const std::uint32_t marker : {2U, 3U}) {
    ASSERT_TRUE(supervisor_->correct_session({.session_id = other, .marker = marker, .marker_text = "", .reason = "had an ID"}, kAnna));
  }
  EXPECT_THAT(recordings_->sessions_mentioning("P071")->sessions, IsEmpty()) << "no list has the ID any more";
}

TEST_F(EditTest, AnAttemptThatTwoPartsHave_IsCorrectedOnlyInTheNamedPart) {
  start({Protocol{}, standing()});
  const std::string id = stand();
  change_catalogue(  // as earlier builds counted: each part from attempt 1
      "CREATE TEMP TABLE p AS SELECT * FROM parts; UPDATE p SET part = 2; INSERT INTO parts SELECT * FROM p;"
      "CREATE TEMP TABLE t AS SELECT * FROM trials; UPDATE t SET part = 2; INSERT INTO trials SELECT * FROM t");
  const auto outcomes = [&] {
    std::string text;
    const record::SessionRow session = row(id);
    for (const record::TrialRow& one : session.trials) {
      text += std::to_string(one.part) + "." + std::to_string(one.trial) + "." + std::to_string(one.attempt) + " " + one.outcome + ", ";
    }
    return text;
  };
  CorrectionRequest request{.session_id = id, .trial = 1, .attempt = 1, .outcome = "rejected", .reason = "talked"};
  EXPECT_EQ(why_refused(supervisor_->correct_session(request, kAnna), core::ErrorCode::InvalidArgument),
            "parts 1 and 2 of session " + id + " have attempt 1 of trial 1; name its part: dtsctl session edit " + id +
                " --trial 1 --attempt 1 --part 2");
  request.part = 3;
  EXPECT_THAT(why_refused(supervisor_->correct_session(request, kAnna), core::ErrorCode::NotFound),
              HasSubstr("no attempt 1 of trial 1 in part 3"));
  EXPECT_EQ(outcomes(), "1.1.1 done, 1.2.1 done, 2.1.1 done, 2.2.1 done, ");
  request.part = 1;
  ASSERT_TRUE(supervisor_->correct_session(request, kAnna));
  EXPECT_EQ(outcomes(), "1.1.1 rejected, 1.2.1 done, 2.1.1 done, 2.2.1 done, ");
  request.outcome = "done";
  EXPECT_THAT(why_refused(supervisor_->correct_session(request, kAnna)), HasSubstr("attempt 1 of part 2 is done"));
  ASSERT_TRUE(supervisor_->correct_session({.session_id = id, .trial = 2, .outcome = "rejected", .reason = "talked"}, kAnna));
  EXPECT_EQ(outcomes(), "1.1.1 rejected, 1.2.1 done, 2.1.1 done, 2.2.1 rejected, ") << "without an attempt: the newest";
}

TEST_F(EditTest, ValuesThatAreNotAllowed_AreRejected) {
  start({Protocol{}, standing()});
  const std::string id = stand();
  const auto why = [&](CorrectionRequest request, core::ErrorCode code) {
    request.session_id = id;
    return why_refused(supervisor_->correct_session(request, kAnna), code);
  };
  using enum core::ErrorCode;
  EXPECT_THAT(why({.subject = "P017"}, InvalidArgument), HasSubstr("the reason is missing"));
  EXPECT_THAT(why({.subject = "Anna Schmidt", .reason = "r"}, InvalidArgument), HasSubstr("subject ID must have"));
  EXPECT_THAT(why({.subject = "=cmd|' /C calc'!A0", .reason = "r"}, InvalidArgument), HasSubstr("subject ID must have"));
  EXPECT_THAT(why({.subject = "P071", .reason = "r"}, InvalidArgument), HasSubstr("nothing to correct"));
  EXPECT_THAT(why({.reason = "r"}, InvalidArgument), HasSubstr("nothing to correct"));
  EXPECT_THAT(why({.notes = std::string(10'000, 'x'), .reason = "r"}, InvalidArgument), HasSubstr("10000 bytes, more than 1000"));
  EXPECT_THAT(why({.label = std::string(10'000, 'x'), .reason = "r"}, InvalidArgument), HasSubstr("more than 200"));
  EXPECT_THAT(why({.subject = "P1", .reason = std::string(10'000, 'x')}, InvalidArgument), HasSubstr("more than 200"));
  for (const std::string bad : {"a\nb", "a\x1b[31m",
                                "\xE2\x80\xAE"
                                "abc",
                                "\xFF", "a\x7f"}) {
    EXPECT_THAT(why({.notes = bad, .reason = "r"}, InvalidArgument), HasSubstr("not visible"));
    EXPECT_THAT(why({.label = bad, .reason = "r"}, InvalidArgument), HasSubstr("not visible"));
    EXPECT_THAT(why({.subject = "P1", .reason = bad}, InvalidArgument), HasSubstr("not visible"));
  }
  EXPECT_THAT(why({.trial = 1, .reason = "r"}, InvalidArgument), HasSubstr("both a trial and an outcome"));
  EXPECT_THAT(why({.outcome = "done", .reason = "r"}, InvalidArgument), HasSubstr("both a trial and an outcome"));
  EXPECT_THAT(why({.trial = 1, .outcome = "good", .reason = "r"}, InvalidArgument), HasSubstr("outcome is not known"));
  EXPECT_THAT(why({.trial = 3, .outcome = "done", .reason = "r"}, NotFound), HasSubstr("no trial 3"));
  EXPECT_THAT(why({.trial = 1, .attempt = 2, .outcome = "done", .reason = "r"}, NotFound), HasSubstr("no attempt 2 of trial 1"));
  EXPECT_TRUE(row(id).corrections.empty());
  EXPECT_FALSE(std::filesystem::exists(corrections_file(id)));
  EXPECT_EQ(supervisor_->correct_session({.session_id = "none", .subject = "P1", .reason = "r"}, kAnna).error().code, NotFound);
}

TEST_F(EditTest, ATrialIsDoneOnce_AndOnlyWithValues) {
  start({Protocol{}, standing()});
  const std::string id = record(kBlock, {.protocol = "standing"});
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass(13.0);
  ASSERT_TRUE(eventually([&] { return !row(id).trials.at(0).result.empty(); }));
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Redo));  // attempt 1 is redone; attempt 2 begins
  pass(13.0);
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass(2.0);
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Reject));  // trial 2 ends before it was measured
  ASSERT_TRUE(stop());
  const auto why = [&](std::uint32_t trial, std::uint32_t attempt) {
    return why_refused(
        supervisor_->correct_session({.session_id = id, .trial = trial, .attempt = attempt, .outcome = "done", .reason = "r"}, kAnna));
  };
  EXPECT_THAT(why(1, 1), HasSubstr("attempt 2 is done"));
  EXPECT_THAT(why(2, 1), HasSubstr("has no values"));
  ASSERT_TRUE(supervisor_->correct_session({.session_id = id, .trial = 1, .attempt = 2, .outcome = "redone", .reason = "r"}, kAnna));
  EXPECT_TRUE(supervisor_->correct_session({.session_id = id, .trial = 1, .attempt = 1, .outcome = "done", .reason = "r"}, kAnna));
}

TEST_F(EditTest, OnlyClosedSessionsAreCorrected) {
  start({Protocol{}, standing()});
  const std::string id = record(kBlock, {.subject = "P071"});
  EXPECT_THAT(why_refused(supervisor_->correct_session({.session_id = id, .subject = "P017", .reason = "r"}, kAnna)),
              HasSubstr("is not closed yet"));
  EXPECT_THAT(why_refused(supervisor_->delete_session(id, "r", false, kAnna)), HasSubstr("is not closed yet"));
  EXPECT_THAT(why_refused(supervisor_->erase_subject("P071", kAnna)), HasSubstr("a session of this subject is running"));
  EXPECT_TRUE(stop());
}

TEST_F(EditTest, ADeletedSessionIsHidden_AndRestored) {
  start({Protocol{}, standing()});
  const std::string id = brief("P017");
  EXPECT_EQ(why_refused(supervisor_->delete_session(id, "", false, kAnna), core::ErrorCode::InvalidArgument).substr(0, 21),
            "the reason is missing");
  ASSERT_TRUE(supervisor_->delete_session(id, "a test", false, kAnna));
  EXPECT_TRUE(recordings_->catalogue().sessions({})->empty());
  EXPECT_TRUE(std::filesystem::exists(row(id).parts.at(0).file));
  EXPECT_THAT(why_refused(supervisor_->delete_session(id, "again", false, kAnna)), HasSubstr("is deleted already"));
  EXPECT_THAT(why_refused(supervisor_->correct_session({.session_id = id, .subject = "P1", .reason = "r"}, kAnna)),
              HasSubstr("restore it first"));
  EXPECT_THAT(why_refused(supervisor_->resume_session(id)), HasSubstr("is deleted"));
  restart();
  EXPECT_TRUE(row(id).is_deleted);
  ASSERT_TRUE(supervisor_->delete_session(id, "", true, kAnna));
  EXPECT_EQ(recordings_->catalogue().sessions({})->size(), 1U);
  EXPECT_THAT(why_refused(supervisor_->delete_session(id, "", true, kAnna)), HasSubstr("is not deleted"));
}

TEST_F(EditTest, AnErasedSubjectLeavesNothing) {
  start({Protocol{}, standing()});
  const std::string other = brief("P018");
  const std::string second = brief("P017");
  const std::string third = stand("P017");
  ASSERT_TRUE(supervisor_->delete_session(second, "a test", false, kAnna));
  ASSERT_TRUE(supervisor_->correct_session({.session_id = third, .notes = "n", .reason = "r"}, kAnna));
  ASSERT_TRUE(supervisor_->correct_session({.session_id = other, .notes = "as P017.", .reason = "not P0170"}, kAnna));
  EXPECT_THAT(recordings_->sessions_mentioning("P017")->sessions, ElementsAre(other));
  EXPECT_EQ(recordings_->sessions_mentioning("P017")->unsearched, 0U);
  const Mentions bounded = recordings_->sessions_mentioning("P017", 1).value();
  EXPECT_THAT(bounded.sessions, ElementsAre(other));
  EXPECT_EQ(bounded.unsearched, 0U) << "the subject's own sessions are not searched";
  EXPECT_EQ(recordings_->sessions_mentioning("P017", 0)->unsearched, 1U);

  ASSERT_TRUE(supervisor_->erase_subject("P017", kAnna));
  EXPECT_THAT(listed(), ElementsAre(other)) << "already";
  const auto done = erased();
  ASSERT_TRUE(done);
  EXPECT_EQ(done->sessions, 2U);
  EXPECT_EQ(done->mentions, 1U);
  EXPECT_THAT(done->left, IsEmpty());
  EXPECT_THAT(files(), ElementsAre(other + ".corrections.json", other + ".xdf", other + ".xdf.idx"));
  EXPECT_EQ(row(other).notes, "as [erased].");
  EXPECT_EQ(row(other).corrections.at(0).reason, "not P0170");
  EXPECT_EQ(now().session.id, "") << "the status does not show its last session";
  EXPECT_EQ(now().recording.file, "") << "nor its recording";
  EXPECT_FALSE(std::filesystem::exists(folder_ / "erasure.json"));
  EXPECT_EQ(recordings_->erasures(), 1U);
  ASSERT_TRUE(recordings_->catalogue().verify_audit());
  const auto entry = recordings_->catalogue().audit(1)->back();
  EXPECT_EQ(entry.who + " " + entry.what + " " + entry.target + " " + entry.result, "local:anna erase_subject 2 sessions ok");
  EXPECT_EQ(supervisor_->erase_subject("P017", kAnna).error().code, core::ErrorCode::NotFound);
  restart();
  EXPECT_THAT(listed(), ElementsAre(other));
}

TEST_F(EditTest, AnErasureThatACrashInterrupted_IsCompletedAtTheStart_Once) {
  start({Protocol{}, standing()});
  const std::string id = brief("P017");
  const std::string other = brief("P018");
  end();
  const record::Erasure erasure{.subject = "P017", .who = kAnna, .utc_ns = 77, .sessions = {id}};
  ASSERT_TRUE(record::write_erasure(folder_.string(), erasure));  // the crash came right after this

  open({Protocol{}, standing()});
  EXPECT_TRUE(std::filesystem::exists(folder_ / "erasure.json")) << "writing the catalogue again must not delay the start";
  EXPECT_THAT(listed(), ElementsAre(other));
  run();
  EXPECT_TRUE(is_completed());

  EXPECT_THAT(listed(), ElementsAre(other));
  EXPECT_THAT(files(), ElementsAre(other + ".xdf", other + ".xdf.idx"));
  const auto count = [this] {
    std::size_t entries = 0;
    const auto trail = recordings_->catalogue().audit(1000).value();
    for (const record::AuditEntry& entry : trail)
      entries += entry.what == "erase_subject" && entry.who == kAnna && entry.target == "1 session" ? 1 : 0;
    return entries;
  };
  EXPECT_EQ(count(), 1U);
  EXPECT_THAT(log(), HasSubstr("a subject was erased: 1 session, 2 files"));
  end();
  ASSERT_TRUE(record::write_erasure(folder_.string(), erasure));  // or before the note was removed
  start({Protocol{}, standing()});
  EXPECT_TRUE(is_completed());
  EXPECT_EQ(count(), 1U);
  EXPECT_TRUE(recordings_->catalogue().verify_audit());
}

TEST_F(EditTest, AnErasureThatTheEndOfTheDaemonMeets_IsCompletedThenOrAtTheStart) {
  start({Protocol{}, standing()});
  const std::string other = brief("P018");
  static_cast<void>(brief("P017"));
  ASSERT_TRUE(supervisor_->erase_subject("P017", kAnna));
  restart();
  EXPECT_THAT(listed(), ElementsAre(other));
  EXPECT_THAT(files(), ElementsAre(other + ".xdf", other + ".xdf.idx"));
  EXPECT_TRUE(is_completed());
  const auto trail = recordings_->catalogue().audit(1000).value();
  EXPECT_EQ(std::ranges::count(trail, std::string("erase_subject"), &record::AuditEntry::what), 1);
}

TEST_F(EditTest, TheFolderOfTheRecordingsItselfMayBeALink) {
  start({Protocol{}, standing()});
  const std::string id = brief("P017");
  end();
  ASSERT_TRUE(record::write_erasure(folder_.string(), {.subject = "P017", .who = kAnna, .utc_ns = 77, .sessions = {id}}));
  std::filesystem::create_directories(folder_ / "sessions" / "a" / (id + ".xdf.d"));
  std::filesystem::rename(folder_ / "sessions", folder_ / "kept");
  std::filesystem::create_directory_symlink(folder_ / "kept", folder_ / "sessions");
  start({Protocol{}, standing()});
  EXPECT_THAT(listed(), IsEmpty()) << "the folder of the recordings itself may be a link";
  EXPECT_FALSE(std::filesystem::exists(folder_ / "kept" / (id + ".xdf")));
}

TEST_F(EditTest, ARecordingThatIsALink_KeepsEverything) {
  start({Protocol{}, standing()});
  const std::string id = brief("P017");
  const std::string file = row(id).parts.at(0).file;
  std::filesystem::rename(file, folder_ / "elsewhere.xdf");
  std::filesystem::create_symlink(folder_ / "elsewhere.xdf", file);
  EXPECT_THAT(why_refused(supervisor_->erase_subject("P017", kAnna), core::ErrorCode::NotAllowed), HasSubstr("is a link, or is not in"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "elsewhere.xdf"));
  EXPECT_TRUE(std::filesystem::exists(file));
  EXPECT_THAT(listed(), ElementsAre(id));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "erasure.json"));
}

TEST_F(EditTest, ARecordingOfAnotherSubjectStays_AndIsReported) {
  start({Protocol{}, standing()});
  const std::string id = brief("P017");
  ASSERT_TRUE(supervisor_->correct_session({.session_id = id, .subject = "P018", .reason = "typing error"}, kAnna));
  ASSERT_TRUE(supervisor_->erase_subject("P017", kAnna));
  const auto done = erased();
  ASSERT_TRUE(done);
  EXPECT_EQ(done->sessions, 0U);
  EXPECT_EQ(done->mentions, 1U);
  ASSERT_EQ(done->left.size(), 1U);
  EXPECT_THAT(done->left[0], HasSubstr(id));
  EXPECT_THAT(log(), HasSubstr("not erased: " + done->left[0])) << "the client may have stopped waiting";
  EXPECT_EQ(row(id).subject + " " + row(id).corrections.at(0).old_value, "P018 [erased]");
  EXPECT_TRUE(std::filesystem::exists(row(id).parts.at(0).file));
}

TEST_F(EditTest, ADamagedFileOfNotesOfAnotherSubject_HindersNoErasure) {
  RecordProperty("requirement", "SES-10");
  start({Protocol{}, standing()});
  const std::string recording = row(brief("P017")).parts.at(0).file;
  std::filesystem::create_directories(folder_ / "sessions" / "subjects");
  std::ofstream(folder_ / "sessions" / "subjects" / "Q1.json") << "garbage";
  ASSERT_TRUE(supervisor_->erase_subject("P017", kAnna));
  const auto done = erased();
  ASSERT_TRUE(done);
  EXPECT_EQ(done->sessions, 1U);
  EXPECT_FALSE(std::filesystem::exists(recording));
  ASSERT_EQ(done->left.size(), 1U);
  EXPECT_THAT(done->left[0], HasSubstr("Q1.json' cannot be read"));
  const std::string said = log();
  EXPECT_THAT(said, HasSubstr("subjects/ID.json' cannot be read")) << "log lines have no subject";
  EXPECT_THAT(said, Not(HasSubstr("Q1")));
  EXPECT_TRUE(is_completed());
}

TEST_F(EditTest, NotesThatCannotBeRemoved_AreNamedInTheAnswerAndNotInTheLog) {
  RecordProperty("requirement", "SES-10");
  start({Protocol{}, standing()});
  brief("P017");
  std::filesystem::create_directories(folder_ / "sessions" / "subjects" / "P017.json");
  EXPECT_THAT(supervisor_->erase_subject("P017", kAnna).error().what, HasSubstr("cannot remove '"));
  const std::string said = log();
  EXPECT_THAT(said, HasSubstr("an erasure is not complete: cannot remove '"));
  EXPECT_THAT(said, Not(HasSubstr("P017")));
}

TEST_F(EditTest, ResultsFollowTheOutcomes_AlsoIfTheDaemonEndedBeforeTheyWereWritten) {
  start({Protocol{}, standing()});
  const std::string id = stand();
  record::Corrections all{.session_id = id};
  all.add({.who = kAnna,
           .field = record::CorrectedField::Outcome,
           .part = 1,
           .trial = 2,
           .attempt = 1,
           .old_value = "done",
           .new_value = "rejected",
           .reason = "r"});
  ASSERT_TRUE(record::write_corrections(corrections_file(id), all));
  ASSERT_TRUE(recordings_->catalogue().set_corrections(all));
  ASSERT_TRUE(results(id).contains("romberg/MVELO"));
  restart();
  EXPECT_FALSE(results(id).contains("romberg/MVELO"));
  EXPECT_TRUE(results(id).contains("open/MVELO"));
}

TEST_F(EditTest, IfTheResultsCannotBeComputed_NothingIsChanged) {
  start({Protocol{}, standing()});
  const std::string id = stand();
  const auto before = results(id);
  record::TrialRow trial = row(id).trials.at(0);
  trial.result = "{damaged";
  ASSERT_TRUE(recordings_->catalogue().put_trial(trial));
  EXPECT_EQ(supervisor_->correct_session({.session_id = id, .trial = 2, .outcome = "rejected", .reason = "r"}, kAnna).error().code,
            core::ErrorCode::DataDamaged);
  EXPECT_TRUE(row(id).corrections.empty());
  EXPECT_EQ(results(id), before);
  EXPECT_FALSE(std::filesystem::exists(corrections_file(id)));
}

TEST_F(EditTest, AFileOfCorrectionsThatSomebodyChanged_IsNotReplaced) {
  start({Protocol{}, standing()});
  const std::string id = brief("P071");
  std::ofstream(corrections_file(id)) << "damaged";
  EXPECT_EQ(supervisor_->correct_session({.session_id = id, .notes = "n", .reason = "r"}, kAnna).error().code,
            core::ErrorCode::DataDamaged);
  record::Corrections other{.session_id = id};
  other.add({.who = kAnna, .field = record::CorrectedField::Notes, .old_value = "", .new_value = "theirs", .reason = "r"});
  ASSERT_TRUE(record::write_corrections(corrections_file(id), other));
  EXPECT_THAT(why_refused(supervisor_->correct_session({.session_id = id, .notes = "n", .reason = "r"}, kAnna)),
              HasSubstr("are not those that dtsd knows"));
  EXPECT_EQ(record::read_corrections(corrections_file(id)).value(), other);
  EXPECT_TRUE(row(id).corrections.empty());
}

TEST_F(EditTest, AfterTheLastCorrection_ATextCanStillBeRemoved_AndTheSessionDeleted) {
  start({Protocol{}, standing()});
  const std::string id = brief("P071");
  record::Corrections all{.session_id = id};
  for (std::size_t count = 0; count < record::kMostCorrections; ++count) {
    all.add({.who = kAnna, .field = record::CorrectedField::Notes, .old_value = "", .new_value = std::to_string(count), .reason = "r"});
  }
  ASSERT_TRUE(record::write_corrections(corrections_file(id), all));
  ASSERT_TRUE(recordings_->catalogue().set_corrections(all));
  const auto corrected = [&](const std::string& notes) {
    return supervisor_->correct_session({.session_id = id, .notes = notes, .reason = "r"}, kAnna);
  };
  EXPECT_THAT(why_refused(corrected("n"), core::ErrorCode::LimitExceeded), HasSubstr("at most 1000"));
  EXPECT_TRUE(corrected(""));
  EXPECT_TRUE(supervisor_->delete_session(id, "r", false, kAnna));
  restart();
  EXPECT_TRUE(row(id).is_deleted);
  EXPECT_EQ(row(id).notes, "");
}

TEST_F(EditTest, WordsOfDtsdAreNoMentions) {
  start({Protocol{}, standing()});
  const std::string other = stand("P018");
  ASSERT_TRUE(supervisor_->correct_session({.session_id = other, .trial = 2, .outcome = "rejected", .reason = "not done"}, kAnna));
  ASSERT_TRUE(supervisor_->delete_session(other, "yes", false, kAnna));
  for (const std::string word : {"done", "yes"}) {
    EXPECT_EQ(supervisor_->erase_subject(word, kAnna).error().code, core::ErrorCode::NotFound) << "only reasons have it";
    EXPECT_FALSE(std::filesystem::exists(folder_ / "erasure.json"));
    static_cast<void>(brief(word));
    ASSERT_TRUE(supervisor_->erase_subject(word, kAnna)) << word;
    ASSERT_TRUE(erased());
  }
  EXPECT_THAT(listed(), ElementsAre(other));
  const auto corrections = row(other).corrections;
  EXPECT_EQ(corrections.at(0).old_value + " " + corrections.at(0).new_value + " " + corrections.at(0).reason, "done rejected not [erased]");
  EXPECT_EQ(corrections.at(1).new_value + " " + corrections.at(1).reason, "yes [erased]");
  EXPECT_TRUE(row(other).is_deleted);
  EXPECT_EQ(record::read_corrections(corrections_file(other))->all, corrections);
}

TEST_F(EditTest, NotesThatBecomeLongerByAnErasure_CanStillBeRead) {
  start({Protocol{}, standing()});
  const std::string other = brief("P018");
  std::string notes;
  while (notes.size() < 998) notes += "A ";
  ASSERT_TRUE(supervisor_->correct_session({.session_id = other, .notes = notes + "A", .reason = "r"}, kAnna));
  static_cast<void>(brief("A"));
  ASSERT_TRUE(supervisor_->erase_subject("A", kAnna));
  ASSERT_TRUE(erased());
  const auto read = record::read_corrections(corrections_file(other));
  ASSERT_TRUE(read) << read.error().what;
  EXPECT_EQ(read->all, row(other).corrections);
  EXPECT_EQ(row(other).notes.find('A'), std::string::npos);
}

TEST_F(EditTest, ASubjectIsNotErased_WhileARecordingIsMissing) {
  start({Protocol{}, standing()});
  const std::string id = brief("P017");
  const std::string file = row(id).parts.at(0).file;
  std::filesystem::rename(file, folder_ / "unmounted");
  EXPECT_THAT(why_refused(supervisor_->erase_subject("P017", kAnna)), HasSubstr(file + " is missing"));
  EXPECT_THAT(listed(), ElementsAre(id));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "erasure.json"));
  std::ofstream{file};  // it is gone for ever
  ASSERT_TRUE(supervisor_->erase_subject("P017", kAnna));
  const auto done = erased();
  ASSERT_TRUE(done);
  EXPECT_THAT(done->left, IsEmpty());
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(EditTest, AMissingRecordingOutsideTheFolder_IsReported) {
  start({Protocol{}, standing()});
  const std::string id = brief("P017");
  record::PartRow part = row(id).parts.at(0);
  part.file = "/nowhere/a.xdf";
  ASSERT_TRUE(recordings_->catalogue().update_part(part));
  ASSERT_TRUE(supervisor_->erase_subject("P017", kAnna));
  const auto done = erased();
  ASSERT_TRUE(done);
  EXPECT_THAT(done->left, ElementsAre("the recording '/nowhere/a.xdf' is missing; if it is elsewhere, remove it there"));
}

TEST_F(EditTest, AnErasureThatIsRepeated_IncludesSessionsThatCameSince) {
  start({Protocol{}, standing()});
  const std::string other = brief("P018");
  ASSERT_TRUE(supervisor_->correct_session({.session_id = other, .notes = "as P017", .reason = "r"}, kAnna));
  static_cast<void>(brief("P017"));
  std::filesystem::create_directories(corrections_file(other) + ".new/in the way");
  EXPECT_EQ(supervisor_->erase_subject("P017", kAnna).error().code, core::ErrorCode::Failed);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "erasure.json"));
  static_cast<void>(brief("P017"));
  std::filesystem::remove_all(corrections_file(other) + ".new");
  ASSERT_TRUE(supervisor_->erase_subject("P017", kAnna));
  const auto done = erased();
  ASSERT_TRUE(done);
  EXPECT_EQ(done->sessions, 2U);
  EXPECT_THAT(listed(), ElementsAre(other));
  EXPECT_THAT(files(), ElementsAre(other + ".corrections.json", other + ".xdf", other + ".xdf.idx"));
}

TEST_F(EditTest, ALabelThatWasRemoved_IsNotRecordedAgain) {
  start({Protocol{}, standing()});
  const std::string id = record(kBlock, {.protocol = "standing", .label = "Anna Schmidt"});
  ASSERT_TRUE(supervisor_->trial("", TrialAction::Next));
  pass(13.0);
  ASSERT_TRUE(stop());
  ASSERT_TRUE(supervisor_->correct_session({.session_id = id, .label = "", .reason = "had a name"}, kAnna));
  EXPECT_EQ(row(id).recorded_label, "") << "the catalogue does not keep it";
  ASSERT_TRUE(supervisor_->resume_session(id));
  pass(1.0);
  ASSERT_TRUE(stop());
  ASSERT_EQ(row(id).parts.size(), 2U);
  EXPECT_EQ(record::read_session_facts(row(id).parts.at(0).file)->label, "Anna Schmidt") << "the recording stays as it is";
  EXPECT_EQ(record::read_session_facts(row(id).parts.at(1).file)->label, "");
}

TEST_F(EditTest, AnErasureThatWasInterrupted_CleansCorrectionsOfADamagedCatalogueToo) {
  start({Protocol{}, standing()});
  const std::string id = brief("P017");
  const std::string other = brief("P018");
  ASSERT_TRUE(supervisor_->correct_session({.session_id = other, .notes = "as P017", .reason = "r"}, kAnna));
  end();
  ASSERT_TRUE(record::write_erasure(folder_.string(), {.subject = "P017", .who = kAnna, .utc_ns = 77, .sessions = {id}}));
  for (const char* name : {"catalogue.sqlite", "catalogue.sqlite-wal", "catalogue.sqlite-shm", "catalogue.sqlite.audit"})
    std::filesystem::remove(folder_ / name);
  start({Protocol{}, standing()});
  EXPECT_THAT(listed(), ElementsAre(other));
  EXPECT_EQ(row(other).notes, "as [erased]");
  EXPECT_EQ(record::read_corrections(corrections_file(other))->all, row(other).corrections);
  EXPECT_TRUE(is_completed());
}

TEST_F(EditTest, AnErasureIsNotForgotten_UntilItIsInTheAuditTrail) {
  start({Protocol{}, standing()});
  static_cast<void>(brief("P017"));
  change_catalogue("CREATE TRIGGER full BEFORE INSERT ON audit BEGIN SELECT RAISE(ABORT, 'full'); END");
  ASSERT_TRUE(supervisor_->erase_subject("P017", kAnna));
  std::optional<core::Result<record::Erased>> done;
  ASSERT_TRUE(eventually([&] {
    done = recordings_->take_erased();
    return done.has_value();
  }));
  EXPECT_FALSE(*done);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "erasure.json"));
  change_catalogue("DROP TRIGGER full");
  restart();
  EXPECT_TRUE(is_completed());
  ASSERT_EQ(erasures_in_audit().size(), 1U);
  EXPECT_EQ(erasures_in_audit()[0].target + " " + erasures_in_audit()[0].who, "1 session local:anna");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "erasure.json"));
}

/// Reads the catalogue from its construction to its end. An erasure waits 1 s for it, and nothing can be written meanwhile.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& folder) {
    EXPECT_EQ(sqlite3_open((folder / "catalogue.sqlite").c_str(), &database_), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database_, "BEGIN; SELECT count(*) FROM sessions", nullptr, nullptr, nullptr), SQLITE_OK);
  }
  ~Reader() { sqlite3_close(database_); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

 private:
  sqlite3* database_ = nullptr;
};

TEST_F(EditTest, WhileTheCatalogueIsWrittenAgain_ErrorsSayWhatToDo) {
  start({Protocol{}, standing()});
  const std::string other = brief("P018");
  static_cast<void>(brief("P017"));
  static_cast<void>(log());
  const std::string busy = "dtsd is writing its catalogue again, because a subject was erased; try again in some seconds";
  {
    const Reader reader(folder_);
    ASSERT_TRUE(supervisor_->erase_subject("P017", kAnna));
    core::Result<record::SessionRow> corrected;
    for (int number = 0; (number == 0 || corrected) && number < 900; ++number) {
      corrected = supervisor_->correct_session({.session_id = other, .notes = std::to_string(number), .reason = "r"}, kAnna);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_EQ(why_refused(corrected), busy);
    EXPECT_EQ(why_refused(supervisor_->start_session("floor", {})), busy);
    recordings_->enter_audit({.utc_ns = 1, .who = "local", .what = "mark", .target = "floor", .result = "ok"});
    recordings_->enter_attempt(other, 1, 1);
    EXPECT_EQ(why_refused(supervisor_->delete_session(other, "r", false, kAnna)), busy) << "an entry waits";
  }
  ASSERT_TRUE(erased());
  EXPECT_TRUE(supervisor_->delete_session(other, "r", false, kAnna)) << "nothing waits any more";
  EXPECT_EQ(log().find("catalogue:"), std::string::npos) << "entries that only wait are no errors";
}

TEST_F(EditTest, DuringAnErasure_OtherErrorsOfTheCatalogueStay) {
  start({Protocol{}, standing()});
  const std::string other = brief("P018");
  static_cast<void>(brief("P017"));
  ASSERT_TRUE(supervisor_->erase_subject("P017", kAnna));
  ASSERT_TRUE(std::filesystem::exists(folder_ / "catalogue.sqlite-wal"));
  while (std::filesystem::file_size(folder_ / "catalogue.sqlite-wal") > 0) std::this_thread::yield();  // the last step of its thread
  EXPECT_THAT(
      why_refused(recordings_->begin({{rig(), {.session_id = other, .part = 2, .rig = "floor", .protocol = "free", .subject = "P019"}}})),
      HasSubstr("is known with another rig, protocol or subject"));
}

TEST_F(EditTest, EntriesThatWaitForAnErasure_AreMadeBeforeTheEnd) {
  start({Protocol{}, standing()});
  const std::string other = brief("P018");
  static_cast<void>(brief("P017"));
  {
    const Reader reader(folder_);
    ASSERT_TRUE(supervisor_->erase_subject("P017", kAnna));
    for (std::int64_t number = 1; recordings_->audit_problem().empty() && number < 1000; ++number) {
      recordings_->enter_audit({.utc_ns = number, .who = "local", .what = "mark", .target = std::to_string(number), .result = "ok"});
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ASSERT_NE(recordings_->audit_problem(), "");
    recordings_->enter_attempt(other, 3, 2);
    supervisor_->tick();  // retries, in vain
    supervisor_->stop();
  }
  EXPECT_EQ(recordings_->catalogue().newest_attempts(other).value(), (std::map<std::uint32_t, std::uint32_t>{{3, 2}}));
  const auto trail = recordings_->catalogue().audit(1000).value();
  ASSERT_GE(trail.size(), 2U);
  EXPECT_EQ(trail.back().what, "stop");
  EXPECT_EQ(trail[trail.size() - 2].what, "mark");
  EXPECT_EQ(log().find("entries of the audit trail are lost"), std::string::npos);
}

TEST_F(EditTest, AnErasureWithoutRoomForTheCatalogue_IsCompletedWhenThereIsRoom) {
  start({Protocol{}, standing()});
  static_cast<void>(brief("P017"));
  end();
  storage_.stop_below_mib = 1e12;
  start({Protocol{}, standing()});
  ASSERT_TRUE(supervisor_->erase_subject("P017", kAnna));
  std::optional<core::Result<record::Erased>> done;
  ASSERT_TRUE(eventually([&] {
    done = recordings_->take_erased();
    return done.has_value();
  }));
  EXPECT_THAT(why_refused(*done, core::ErrorCode::LimitExceeded), HasSubstr("MB of free space"));
  EXPECT_THAT(files(), IsEmpty()) << "removed anyway: this makes room";
  EXPECT_TRUE(std::filesystem::exists(folder_ / "erasure.json"));
  end();
  storage_.stop_below_mib = 0.0;
  start({Protocol{}, standing()});
  EXPECT_TRUE(is_completed());
  EXPECT_EQ(erasures_in_audit().size(), 1U);
}

TEST_F(EditTest, NotesAndReasonsFollowTheRuleOfLabels) {
  const LabelRule rule{.pattern = core::TextPattern::compile(kDefaultLabelPattern).value(), .hint = std::string(kDefaultLabelHint)};
  const record::SessionRow session{.id = "s1"};
  const auto why = [&](const CorrectionRequest& request) {
    return why_refused(corrections_for(session, request, rule), core::ErrorCode::InvalidArgument);
  };
  EXPECT_THAT(why({.notes = "Anna Schmidt fell", .reason = "note"}), HasSubstr("the text of the notes does not follow this clinic's rule"));
  EXPECT_THAT(why({.notes = "fell", .reason = "Anna Schmidt"}), HasSubstr("the reason does not follow this clinic's rule"));
  EXPECT_EQ(why({.notes = "fell, with a stick", .reason = "added later"}), "");
  EXPECT_EQ(why({.notes = "fell", .reason = "Subject fell. Stopped at once."}), "");
  EXPECT_THAT(why({.notes = "fell", .reason = "Subject fell. Anna Schmidt helped."}), HasSubstr("the reason does not follow"));
  EXPECT_EQ(why_refused(check_reason("Anna Schmidt", rule), core::ErrorCode::InvalidArgument).find("Anna"), std::string::npos);
}

TEST_F(EditTest, SubjectIdsFollowTheRule) {
  RecordProperty("requirement", "SES-12");
  label_rule_ = {.subject_pattern = core::TextPattern::compile("P[0-9]{3}").value(), .subject_hint = "use an ID such as P017"};
  start();
  const auto refused = [](const auto& answer) { return why_refused(answer, core::ErrorCode::InvalidArgument); };
  const std::string message = "the subject ID does not follow this clinic's rule for subject IDs; use an ID such as P017";
  EXPECT_EQ(refused(supervisor_->start_session("floor", {.subject = "Schmidt"})), message);
  EXPECT_EQ(refused(supervisor_->start_session("floor", {.subject = "P0170"})), message) << "the whole ID must match";
  const record::SessionRow old{.id = "s1", .subject = "Schmidt"};
  EXPECT_EQ(refused(corrections_for(old, {.subject = "Meier", .reason = "typing error"}, label_rule_)), message);
  EXPECT_TRUE(corrections_for(old, {.subject = "P017", .reason = "typing error"}, label_rule_));
  EXPECT_TRUE(corrections_for(old, {.subject = "", .reason = "typing error"}, label_rule_)) << "an ID can be removed";
  EXPECT_TRUE(corrections_for(old, {.subject = "Schmidt", .notes = "tired", .reason = "added"}, label_rule_))
      << "it is older than the rule";
  const std::vector<Protocol> protocols{{.name = "stand"}};
  const SubjectEdit plan{.subject = "Schmidt", .change = AddPlan{.protocol = "stand", .due_date = {}}};
  EXPECT_EQ(refused(edited({.subject = "Schmidt"}, plan, {}, protocols, label_rule_)), message) << "the session could not start";
  EXPECT_TRUE(edited({.subject = "P017"}, plan, {}, protocols, label_rule_));
  EXPECT_TRUE(edited({.subject = "Schmidt"}, {.subject = "Schmidt", .change = AddNote{"needs a corset"}}, {}, {}, label_rule_));
  EXPECT_TRUE(supervisor_->start_session("floor", {.subject = "P017"}));
}

TEST_F(EditTest, LabelsAndMarkersFollowTheRule) {
  RecordProperty("requirement", "SES-11");
  const LabelRule rule{.pattern = core::TextPattern::compile(kDefaultLabelPattern).value(), .hint = std::string(kDefaultLabelHint)};
  for (const std::string good :
       {"", "eyes closed", "Baseline 2", "T1 OP", "cough",
        "m\xC3\xBC"
        "de",
        "P017", "trial 3: start", "50%", "2026-11-26", "left/right", "comma, and \"quotes\"", "\u0434\u0438\u0442\u0438\u043d\u0430 2",
        "\u017de\u0161ka l\u00e9kem", "\u05e9\u05dc\u05d5\u05dd", "\u9589\u773c \u7acb\u4f4d"})
    EXPECT_TRUE(check_label(rule, "label", good)) << good;
  for (const std::string bad :
       {"Anna Schmidt, born 1950", "Anna Schmidt", "Frau M\xC3\xBCller", "=cmd|x", "+1", "-1", "@x", "<b>x</b>", "a\tb", " a", "a ", "a  b",
        "\u0410\u043d\u043d\u0430 \u0428\u043c\u0438\u0434\u0442", "Eva \u010cern\u00e1", "Anna\u00a0Schmidt", "Anna\u3000Schmidt", "a\nb",
        "\xE2\x80\xAE"
        "abc"}) {
    const auto checked = check_label(rule, "label", bad);
    ASSERT_FALSE(checked) << bad;
    EXPECT_EQ(checked.error().code, core::ErrorCode::InvalidArgument);
    EXPECT_EQ(checked.error().what.find(bad), std::string::npos) << "it may be a name";
  }
  EXPECT_TRUE(check_sentences(rule, "notes", std::string(1000, 'x'), 1000));
  EXPECT_TRUE(check_sentences(rule, "notes", "Tired. Left knee hurts! T2 repeated.", 1000));
  EXPECT_FALSE(check_sentences(rule, "notes", "Tired. Anna Schmidt helped.", 1000));
  EXPECT_FALSE(check_sentences(rule, "notes", "tired, Left knee", 1000)) << "a new sentence begins after '.', '!' or '?'";
  EXPECT_TRUE(check_sentences(rule, "notes", "", 1000));
  EXPECT_THAT(why_refused(check_label(rule, "marker", "Anna Schmidt"), core::ErrorCode::InvalidArgument),
              HasSubstr("the marker does not follow this clinic's rule for labels; Use words and numbers"));
}

}  // namespace
}  // namespace dts::session
