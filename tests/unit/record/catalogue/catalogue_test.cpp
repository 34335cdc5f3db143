// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/catalogue.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "unit/record/catalogue/catalogue_fixture.h"

namespace dts::record {
namespace {

using catalogue_test::code;
using catalogue_test::facts;
using catalogue_test::what;
using core::ErrorCode;
using testing::ElementsAre;

class CatalogueSessions : public catalogue_test::CatalogueFixture {
 protected:
  std::vector<std::string> ids(const SessionFilter& filter) {
    std::vector<std::string> found;
    const auto sessions = catalogue().sessions(filter);
    if (!sessions) return {what(sessions)};
    for (const SessionRow& session : *sessions) found.push_back(session.id);
    return found;
  }
};

TEST_F(CatalogueSessions, BeginPart_EntersTheSessionWithAll) {
  auto session = facts("20261121T144525Z-floor-1");
  session.label = "it's \"the\" first; DROP TABLE sessions";
  ASSERT_TRUE(catalogue().begin_part(session, "/data/a.xdf.part"));
  const auto found = catalogue().session(session.session_id);
  ASSERT_TRUE(found) << what(found);
  SessionRow expected{.id = session.session_id, .rig = "floor", .protocol = "free", .subject = "P017", .label = session.label};
  expected.state = "running";
  expected.started_utc_ns = 1000;
  expected.recorded_subject = expected.subject;
  expected.recorded_label = expected.label;
  expected.parts = {
      {.session_id = session.session_id, .file = "/data/a.xdf.part", .started_utc_ns = 1000, .rig = "floor", .leading_part = 1}};
  EXPECT_EQ(*found, expected);
}

TEST_F(CatalogueSessions, NoSubjectNoProtocol_IsEnteredToo) {
  SessionFacts bare{.session_id = "s", .rig = "floor"};
  ASSERT_TRUE(catalogue().begin_part(bare, ""));
  ASSERT_TRUE(catalogue().begin_part(facts("t"), ""));
  EXPECT_EQ(catalogue().session("s")->subject, "");
  EXPECT_THAT(ids({.subject = "P017"}), ElementsAre("t"));
}

TEST_F(CatalogueSessions, BadFacts_AreRefusedWithTheirReason) {
  auto huge = facts();
  huge.protocol_definition = std::string(5U << 20U, 'x');
  for (const auto& [session, expected] :
       {std::pair<SessionFacts, std::string>{facts(""), "a session's id is not 1 to 128 letters, digits, '_', '.' or '-'"},
        {facts("a/b"), "a session's id is not 1 to 128 letters, digits, '_', '.' or '-'"},
        {facts("../x"), "a session's id is not 1 to 128 letters, digits, '_', '.' or '-'"},
        {facts("a b"), "a session's id is not 1 to 128 letters, digits, '_', '.' or '-'"},
        {facts("\xc3\xa4"), "a session's id is not 1 to 128 letters, digits, '_', '.' or '-'"},
        {facts(std::string(128, 'x')), ""},
        {facts(std::string(129, 'x')), "a session's id is not 1 to 128 letters, digits, '_', '.' or '-'"},
        {facts("s", 0), "session s names no rig, or part 0"},
        {SessionFacts{.session_id = "s"}, "session s names no rig, or part 0"},
        {huge, "the catalogue (" + path() + "): value 3 is too large"}}) {
    EXPECT_EQ(what(catalogue().begin_part(session, "f")), expected);
  }
  EXPECT_THAT(ids({}), ElementsAre(std::string(128, 'x')));
}

TEST_F(CatalogueSessions, FurtherParts_ContinueTheSessionOrAreRefused) {
  ASSERT_TRUE(catalogue().begin_part(facts("s1", 1, 1000), path("a")));
  ASSERT_TRUE(catalogue().end_session("s1", "interrupted", "power", 2000));
  const std::string before = sessions_text();
  EXPECT_EQ(what(catalogue().begin_part(facts(), path("b"))), "part 1 of session s1 is known already");
  auto other = facts("s1", 2);
  other.subject = "P018";
  EXPECT_EQ(what(catalogue().begin_part(other, path("b"))), "session s1 is known with another rig, protocol or subject");
  EXPECT_EQ(sessions_text(), before);
  ASSERT_TRUE(catalogue().begin_part(facts("s1", 2, 3000), path("b")));
  EXPECT_EQ(sessions_text(),
            "s1 floor free P017 running from 1000 to 0\n"
            "  part 1 a recording 0 scans 0 s, 0 valid, lost unknown 0 s\n"
            "  part 2 b recording 0 scans 0 s, 0 valid, lost unknown 0 s\n");
}

TEST_F(CatalogueSessions, UpdatePart_KeepsAllButTheStart) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "a"));
  PartRow part{.session_id = "s1", .file = "b", .state = PartState::Recovered, .sha256 = "ab", .bytes = 1ULL << 40U, .scans = 7};
  part.duration_s = 12.50000000000007;
  part.lost_s_at_most = 0.75;
  part.losses.emplace().add(core::GapReason::RingFull, {.gaps = 1, .scans = 10'560});
  part.reason = "power";
  part.started_utc_ns = 99;
  ASSERT_TRUE(catalogue().update_part(part));
  part.started_utc_ns = 1000;
  part.rig = "floor";
  part.leading_part = 1;
  part.duration_s = 12.5;
  EXPECT_EQ(catalogue().session("s1")->parts[0], part);
}

TEST_F(CatalogueSessions, LossesThatCannotBeRead_CostThatPartAndNotTheCatalogue) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "a"));
  EXPECT_FALSE(catalogue().session("s1")->parts[0].losses) << "nobody counted them yet";
  ASSERT_TRUE(catalogue().update_part({.session_id = "s1", .losses = core::Losses()}));
  EXPECT_EQ(catalogue().session("s1")->parts[0].losses, core::Losses());
  ASSERT_TRUE(meddle(R"(UPDATE parts SET losses = '{"stall2":{"gaps":1,"scans":5}}')"));
  core::Losses expected;
  expected.add(core::GapReason::None, {.gaps = 1, .scans = 5});
  ASSERT_TRUE(catalogue().parts());
  EXPECT_EQ(catalogue().parts()->at(0).losses, expected) << "a reason of a later version";
  ASSERT_TRUE(meddle("UPDATE parts SET losses = 'nonsense'"));
  ASSERT_TRUE(catalogue().parts());
  EXPECT_FALSE(catalogue().parts()->at(0).losses);
}

TEST_F(CatalogueSessions, WrongCalls_AreRefusedAndChangeNothing) {
  ASSERT_TRUE(catalogue().begin_part(facts(), path("a")));
  const std::string before = sessions_text();
  EXPECT_EQ(what(catalogue().update_part({.session_id = "s1", .part = 2})), "no part 2 of session s1");
  EXPECT_EQ(what(catalogue().update_part({.session_id = "s2"})), "no part 1 of session s2");
  EXPECT_EQ(what(catalogue().update_part({.session_id = "s1", .scans = std::numeric_limits<std::uint64_t>::max()})),
            "the catalogue (" + path() + "): value 5 is too large");
  EXPECT_EQ(what(catalogue().update_part({.session_id = "s1", .duration_s = std::nan("")})),
            "duration or loss of a recording is no number");
  EXPECT_FALSE(catalogue().update_part({.session_id = "s1", .state = static_cast<PartState>(77)}));
  EXPECT_EQ(what(catalogue().end_session("s2", "complete", "", 1)), "no session s2 (see dtsctl session list)");
  for (const char* state : {"running", "", "done"})
    EXPECT_EQ(what(catalogue().end_session("s1", state, "", 1)), "a session cannot end as '" + std::string(state) + "'");
  EXPECT_EQ(what(catalogue().session("s2")), "no session s2 (see dtsctl session list)");
  EXPECT_EQ(what(catalogue().put_trial({.session_id = "s1", .part = 2, .trial = 1, .outcome = "done"})), "no part 2 of session s1");
  EXPECT_EQ(what(catalogue().put_trial({.session_id = "s1", .trial = 1, .outcome = "good"})),
            "a trial has a number, an attempt and one of the outcomes done, redone, rejected, aborted");
  EXPECT_EQ(what(catalogue().put_trial({.session_id = "s1", .trial = 0, .outcome = "done"})),
            "a trial has a number, an attempt and one of the outcomes done, redone, rejected, aborted");
  EXPECT_EQ(what(catalogue().put_result({.session_id = "s1", .name = "x", .value = std::nan("")})), "result 'x' is no number");
  EXPECT_EQ(what(catalogue().put_result({.session_id = "none", .name = "x"})), "no session none (see dtsctl session list)");
  EXPECT_EQ(sessions_text(), before);
  for (const char* state : {"complete", "incomplete", "interrupted", "aborted"}) EXPECT_TRUE(catalogue().end_session("s1", state, "", 1));
}

TEST_F(CatalogueSessions, Filter_FindsNewestFirst) {
  auto chair = facts("c", 1, 50);
  chair.rig = "chair";
  chair.protocol = "reach";
  chair.subject = "P2";
  ASSERT_TRUE(catalogue().begin_part(facts("a", 1, 100), "f"));
  ASSERT_TRUE(catalogue().begin_part(facts("b", 1, 200), "f"));
  ASSERT_TRUE(catalogue().begin_part(chair, "f"));
  EXPECT_THAT(ids({}), ElementsAre("b", "a", "c"));
  EXPECT_THAT(ids({.limit = 1}), ElementsAre("b"));
  EXPECT_THAT(ids({.limit = 0}), ElementsAre());
  EXPECT_THAT(ids({.limit = std::numeric_limits<std::size_t>::max()}), ElementsAre("b", "a", "c"));
  EXPECT_THAT(ids({.rig = "floor"}), ElementsAre("b", "a"));
  EXPECT_THAT(ids({.subject = "P2"}), ElementsAre("c"));
  EXPECT_THAT(ids({.rig = "floor", .protocol = "reach"}), ElementsAre());
  EXPECT_THAT(ids({.rig = "' OR 1=1 --"}), ElementsAre());
}

TEST_F(CatalogueSessions, List_HasPartsButNoTrials) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "f"));
  ASSERT_TRUE(catalogue().put_trial({.session_id = "s1", .trial = 1, .outcome = "done"}));
  const auto sessions = catalogue().sessions({});
  EXPECT_EQ(sessions->at(0).parts.size(), 1U);
  EXPECT_TRUE(sessions->at(0).trials.empty());
  EXPECT_EQ(catalogue().session("s1")->trials.size(), 1U);
}

TEST_F(CatalogueSessions, Trial_IsReplacedByItsLaterOutcome) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "f"));
  TrialRow trial{.session_id = "s1", .trial = 3, .condition = "120", .outcome = "done", .segment = 2, .first_scan = 10, .last_scan = 20};
  ASSERT_TRUE(catalogue().put_trial(trial));
  trial.outcome = "redone";
  ASSERT_TRUE(catalogue().put_trial(trial));
  trial.attempt = 2;
  trial.outcome = "done";
  ASSERT_TRUE(catalogue().put_trial(trial));
  const auto trials = catalogue().session("s1")->trials;
  ASSERT_EQ(trials.size(), 2U);
  EXPECT_EQ(trials[0].outcome, "redone");
  trial.last_segment = 2;  // none was given: the trial lies within one
  EXPECT_EQ(trials[1], trial);
}

TEST_F(CatalogueSessions, NewestAttempts_AreThoseThatHaveBegun_InAnyPart) {
  using testing::Pair;
  ASSERT_TRUE(catalogue().begin_part(facts("s1"), "/data/a.xdf"));
  ASSERT_TRUE(catalogue().begin_part(facts("s1", 2), "/data/b.xdf"));
  ASSERT_TRUE(catalogue().begin_part(facts("s2"), "/data/c.xdf"));
  EXPECT_THAT(catalogue().newest_attempts("s1").value(), testing::IsEmpty());
  ASSERT_TRUE(catalogue().begin_attempt("s1", 1, 1));
  ASSERT_TRUE(catalogue().begin_attempt("s1", 1, 2)) << "under way: it has no row of its own";
  ASSERT_TRUE(catalogue().begin_attempt("s1", 1, 1)) << "an older part was entered again";
  ASSERT_TRUE(catalogue().put_trial({.session_id = "s1", .part = 1, .trial = 2, .attempt = 3, .condition = "a", .outcome = "redone"}));
  ASSERT_TRUE(catalogue().put_trial({.session_id = "s1", .part = 2, .trial = 2, .attempt = 4, .condition = "a", .outcome = "done"}));
  ASSERT_TRUE(catalogue().begin_attempt("s1", 2, 4));
  EXPECT_THAT(catalogue().newest_attempts("s1").value(), ElementsAre(Pair(1, 2), Pair(2, 4)));
  EXPECT_THAT(catalogue().newest_attempts("s2").value(), testing::IsEmpty());
  EXPECT_EQ(code(catalogue().begin_attempt("s3", 1, 1)), ErrorCode::NotFound);
  ASSERT_TRUE(catalogue().erase({"s1"}));
  EXPECT_THAT(catalogue().newest_attempts("s1").value(), testing::IsEmpty());
}

TEST_F(CatalogueSessions, ValidTrials_AreThoseDoneWhoseResultCounts) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "f"));
  ASSERT_TRUE(catalogue().begin_part(facts("s1", 2), "g"));
  const auto put = [this](std::uint32_t part, std::uint32_t trial, const std::string& outcome, const std::string& result) {
    return catalogue().put_trial({.session_id = "s1", .part = part, .trial = trial, .outcome = outcome, .result = result}).has_value();
  };
  ASSERT_TRUE(put(1, 1, "done", R"({"event":"sway","segment":0,"scan":0,"is_valid":true})"));
  ASSERT_TRUE(put(1, 2, "done", R"({"event":"sway","segment":0,"scan":0,"is_valid":false})"));
  ASSERT_TRUE(put(1, 3, "done", R"({"event":"sway","segment":0,"scan":0,"problem":"only 3 s without a gap"})"));
  ASSERT_TRUE(put(1, 4, "rejected", R"({"event":"sway","segment":0,"scan":0,"is_valid":true})"));
  ASSERT_TRUE(put(2, 5, "done", ""));
  ASSERT_TRUE(put(2, 6, "done", R"({"event":"result","segment":0,"scan":0,"number":7,"flags":0,"class":2})"));
  ASSERT_TRUE(put(2, 7, "done", R"({"trial_result":{"trial":7}})")) << "no reach was found";

  EXPECT_EQ(catalogue().session("s1")->parts[0].valid_trials, 1U);
  EXPECT_EQ(catalogue().session("s1")->parts[1].valid_trials, 2U);
  EXPECT_EQ(catalogue().sessions({})->at(0).parts[1].valid_trials, 2U);
}

TEST_F(CatalogueSessions, CompleteSession_SaysWhichOfItsPartsAreNot) {
  const auto state = [](const std::string& of_session, const std::vector<PartState>& parts) {
    SessionRow session{.state = of_session};
    for (const PartState part : parts) session.parts.push_back({.state = part});
    return state_of(session);
  };
  using enum PartState;
  EXPECT_EQ(state("complete", {Complete, Complete}), "complete");
  EXPECT_EQ(state("complete", {Recovered, Complete}), "recovered");
  EXPECT_EQ(state("complete", {Recovered, Incomplete, Complete}), "incomplete");
  EXPECT_EQ(state("complete", {Missing}), "incomplete");
  EXPECT_EQ(state("interrupted", {Recovered}), "interrupted") << "it did not come to its end";
  EXPECT_EQ(state("running", {Recovered, Recording}), "running");
}

TEST_F(CatalogueSessions, UnfinishedParts_AreThoseBeingWritten) {
  ASSERT_TRUE(catalogue().begin_part(facts("a"), "f"));
  ASSERT_TRUE(catalogue().begin_part(facts("b"), "g"));
  ASSERT_TRUE(catalogue().update_part({.session_id = "a", .file = "f", .state = PartState::Complete}));
  const auto unfinished = catalogue().unfinished_parts();
  ASSERT_EQ(unfinished->size(), 1U);
  EXPECT_EQ(unfinished->at(0).session_id, "b");
  EXPECT_EQ(catalogue().parts()->size(), 2U);
}

TEST_F(CatalogueSessions, Results_AreReplacedByName) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "f"));
  ASSERT_TRUE(catalogue().put_result({.session_id = "s1", .name = "path", .value = 1.5, .unit = "mm", .details = "{}"}));
  ASSERT_TRUE(catalogue().put_result({.session_id = "s1", .name = "path", .value = 2.0, .unit = "mm"}));
  ASSERT_TRUE(catalogue().put_result({.session_id = "s1", .name = "area", .value = -3.0, .unit = "mm2"}));
  const auto results = catalogue().results("s1");
  ASSERT_EQ(results->size(), 2U);
  EXPECT_EQ(results->at(0).name, "area");
  EXPECT_EQ(results->at(1).value, 2.0);
  EXPECT_EQ(results->at(1).details, "");
}

TEST_F(CatalogueSessions, Calibration_IsEnteredAgainWithoutHarm) {
  ASSERT_TRUE(catalogue().put_calibration("cop-1", "floor", "cop", "text"));
  EXPECT_TRUE(catalogue().put_calibration("cop-1", "floor", "cop", "text"));
}

TEST_F(CatalogueSessions, StateThatDoesNotExist_IsDamageAndNoEnumerator) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "f"));
  close();
  ASSERT_TRUE(meddle("PRAGMA ignore_check_constraints = ON; UPDATE parts SET state = 9"));
  // Found when it is opened, or at the latest when it is read.
  const auto opened = Catalogue::open(path());
  const auto session = opened ? (*opened)->session("s1") : core::Result<SessionRow>(tl::make_unexpected(opened.error()));
  EXPECT_EQ(code(session), ErrorCode::DataDamaged);
}

TEST_F(CatalogueSessions, Found_IsEnteredWholeOrNotAtAllAndHasTheTrialsOfTheFileOnly) {
  FoundRecording found{.facts = facts(), .session_state = "complete", .ended_utc_ns = 5000};
  found.part = {.session_id = "s1", .file = path("f"), .state = PartState::Complete, .scans = 9};
  found.trials = {{.session_id = "s1", .trial = 1, .outcome = "done"}, {.session_id = "s1", .trial = 2, .outcome = "nonsense"}};
  EXPECT_EQ(what(catalogue().enter(found)), "a trial has a number, an attempt and one of the outcomes done, redone, rejected, aborted");
  EXPECT_EQ(sessions_text(), "");
  found.trials[1].outcome = "redone";
  ASSERT_TRUE(catalogue().enter(found));
  EXPECT_EQ(sessions_text(),
            "s1 floor free P017 complete from 1000 to 5000\n"
            "  part 1 f complete 9 scans 0 s, 1 valid, lost unknown 0 s\n"
            "  trial 1.1.1  done 0:0 to 0:0\n"
            "  trial 1.2.1  redone 0:0 to 0:0\n");
  found.trials.erase(found.trials.begin());
  ASSERT_TRUE(catalogue().enter(found));
  EXPECT_EQ(sessions_text(),
            "s1 floor free P017 complete from 1000 to 5000\n"
            "  part 1 f complete 9 scans 0 s, 0 valid, lost unknown 0 s\n"
            "  trial 1.2.1  redone 0:0 to 0:0\n");
}

TEST_F(CatalogueSessions, FoundOlderPart_LeavesTheSessionAsItIs) {
  ASSERT_TRUE(catalogue().begin_part(facts("s1", 2, 3000), path("b")));
  ASSERT_TRUE(catalogue().end_session("s1", "aborted", "fell ill", 4000));
  FoundRecording found{.facts = facts("s1", 1, 1000), .session_state = "interrupted", .ended_utc_ns = 2000};
  found.part = {.session_id = "s1", .part = 1, .file = path("a"), .state = PartState::Interrupted};
  found.results = {{.session_id = "s1", .name = "eyes-open/MVELO", .value = 8.0, .unit = "mm/s"}};
  ASSERT_TRUE(catalogue().put_result({.session_id = "s1", .name = "eyes-open/MVELO_part_2", .value = 9.0, .unit = "mm/s", .details = ""}));
  ASSERT_TRUE(catalogue().enter(found));
  EXPECT_EQ(catalogue().results("s1")->size(), 2U) << "figures of both parts";
  EXPECT_EQ(sessions_text(),
            "s1 floor free P017 aborted from 1000 to 4000: fell ill\n"
            "  part 1 a interrupted 0 scans 0 s, 0 valid, lost unknown 0 s\n"
            "  part 2 b recording 0 scans 0 s, 0 valid, lost unknown 0 s\n");
}

/// Parts of two rigs: "floor" leads, "plate" records with it.
SessionFacts of_plate(std::uint32_t part, std::uint32_t leading_part, std::int64_t started_utc_ns = 1000) {
  SessionFacts session = facts("s1", part, started_utc_ns);
  session.rig = "plate";
  session.rigs = {"floor", "plate"};
  session.leading_part = leading_part;
  return session;
}

TEST_F(CatalogueSessions, PartsOfSeveralRigs_BeginTogetherOrNotAtAll) {
  ASSERT_TRUE(catalogue().begin_parts({{facts(), path("a")}, {of_plate(2, 1), path("b")}}));
  const SessionRow session = catalogue().session("s1").value();
  EXPECT_EQ(session.rig, "floor");
  EXPECT_THAT(rigs_of(session), ElementsAre("floor", "plate"));
  EXPECT_TRUE(session.parts[0].leads());
  EXPECT_FALSE(session.parts[1].leads());
  EXPECT_THAT(ids({.rig = "plate"}), ElementsAre("s1"));
  EXPECT_THAT(ids({.rig = "chair"}), ElementsAre());
  const std::string before = sessions_text();

  EXPECT_EQ(what(catalogue().begin_parts({{facts("s1", 3), path("c")}, {of_plate(2, 3), path("d")}})),
            "part 2 of session s1 is known already");

  EXPECT_EQ(sessions_text(), before);
}

TEST_F(CatalogueSessions, NewestParts_AreThoseOfAllRigsSinceTheLastResume) {
  ASSERT_TRUE(catalogue().begin_parts({{facts(), path("a")}, {of_plate(2, 1), path("b")}}));
  ASSERT_TRUE(catalogue().begin_parts({{facts("s1", 3), path("c")}, {of_plate(4, 3), path("d")}}));
  std::vector<std::uint32_t> numbers;
  for (const PartRow& part : newest_parts(catalogue().session("s1").value())) numbers.push_back(part.part);
  EXPECT_THAT(numbers, ElementsAre(3U, 4U));
}

TEST_F(CatalogueSessions, FoundPartsOfSeveralRigs_EndTheSessionAsTheWorst_InAnyOrder) {
  FoundRecording floor{.facts = facts(), .session_state = "complete", .ended_utc_ns = 5000};
  floor.part = {.session_id = "s1", .part = 1, .file = path("a"), .state = PartState::Complete};
  FoundRecording plate{.facts = of_plate(2, 1), .session_state = "incomplete", .ended_utc_ns = 4000};
  plate.part = {.session_id = "s1", .part = 2, .file = path("b"), .state = PartState::Incomplete, .reason = "disk"};
  for (const auto& [first, second] : {std::pair(floor, plate), std::pair(plate, floor)}) {
    ASSERT_TRUE(catalogue().enter(first));
    ASSERT_TRUE(catalogue().enter(second));
    const SessionRow session = catalogue().session("s1").value();
    EXPECT_EQ(session.rig + " " + session.state + ": " + session.message + " " + std::to_string(session.ended_utc_ns),
              "floor incomplete: disk 5000");
    ASSERT_TRUE(catalogue().erase({"s1"}));
  }
  EXPECT_EQ(worse_state("incomplete", "interrupted"), "interrupted");
  EXPECT_EQ(worse_state("aborted", "complete"), "aborted");
  EXPECT_EQ(worse_state("complete", "complete"), "complete");
}

TEST_F(CatalogueSessions, StateNames_AreAllDifferent) {
  std::vector<std::string_view> names;
  for (int state = 1; state <= 6; ++state) names.push_back(name(static_cast<PartState>(state)));
  EXPECT_THAT(names, ElementsAre("recording", "complete", "incomplete", "interrupted", "recovered", "missing"));
}

}  // namespace
}  // namespace dts::record
