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
using testing::HasSubstr;

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
  expected.parts = {{.session_id = session.session_id, .file = "/data/a.xdf.part", .started_utc_ns = 1000}};
  EXPECT_EQ(*found, expected);
}

TEST_F(CatalogueSessions, NoSubjectNoProtocol_IsEnteredToo) {
  SessionFacts bare{.session_id = "s", .rig = "floor"};
  ASSERT_TRUE(catalogue().begin_part(bare, ""));
  ASSERT_TRUE(catalogue().begin_part(facts("t"), ""));
  EXPECT_EQ(catalogue().session("s")->subject, "");
  EXPECT_THAT(ids({.subject = "P017"}), ElementsAre("t"));
}

TEST_F(CatalogueSessions, BadFacts_AreRefused) {
  for (const char* id : {"", "a/b", "../x", "a b", "\xc3\xa4"}) {
    EXPECT_EQ(code(catalogue().begin_part(facts(id), "f")), ErrorCode::InvalidArgument) << id;
  }
  EXPECT_EQ(code(catalogue().begin_part(facts(std::string(129, 'x')), "f")), ErrorCode::InvalidArgument);
  EXPECT_EQ(code(catalogue().begin_part(facts("s", 0), "f")), ErrorCode::InvalidArgument);
  EXPECT_EQ(code(catalogue().begin_part({.session_id = "s"}, "f")), ErrorCode::InvalidArgument);
}

TEST_F(CatalogueSessions, SamePartTwice_IsRefusedAndChangesNothing) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "a"));
  ASSERT_TRUE(catalogue().end_session("s1", "complete", "", 2000));
  EXPECT_EQ(code(catalogue().begin_part(facts(), "b")), ErrorCode::WrongState);
  EXPECT_EQ(catalogue().session("s1")->parts[0].file, "a");
  EXPECT_EQ(catalogue().session("s1")->state, "complete");
}

TEST_F(CatalogueSessions, FurtherPart_MakesItRunAgain) {
  ASSERT_TRUE(catalogue().begin_part(facts("s1", 1, 1000), "a"));
  ASSERT_TRUE(catalogue().end_session("s1", "interrupted", "power", 2000));
  ASSERT_TRUE(catalogue().begin_part(facts("s1", 2, 3000), "b"));
  const auto session = catalogue().session("s1");
  EXPECT_EQ(session->state, "running");
  EXPECT_EQ(session->message, "");
  EXPECT_EQ(session->started_utc_ns, 1000);
  EXPECT_EQ(session->ended_utc_ns, 0);
  EXPECT_EQ(session->parts.size(), 2U);
}

TEST_F(CatalogueSessions, FurtherPartOfAnotherSubject_IsRefused) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "a"));
  auto other = facts("s1", 2);
  other.subject = "P018";
  EXPECT_EQ(code(catalogue().begin_part(other, "b")), ErrorCode::WrongState);
  EXPECT_EQ(catalogue().session("s1")->parts.size(), 1U);
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
  part.duration_s = 12.5;
  EXPECT_EQ(catalogue().session("s1")->parts[0], part);
}

TEST_F(CatalogueSessions, LossesOfAPart_AreNotKnownBeforeAnybodyCountedThem) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "a"));
  EXPECT_FALSE(catalogue().session("s1")->parts[0].losses);
  ASSERT_TRUE(catalogue().update_part({.session_id = "s1", .losses = core::Losses()}));
  EXPECT_EQ(catalogue().session("s1")->parts[0].losses, core::Losses());
}

TEST_F(CatalogueSessions, LossesThatCannotBeRead_CostThatPartAndNotTheCatalogue) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "a"));
  ASSERT_TRUE(meddle(R"(UPDATE parts SET losses = '{"stall2":{"gaps":1,"scans":5}}')"));
  core::Losses expected;
  expected.add(core::GapReason::None, {.gaps = 1, .scans = 5});
  ASSERT_TRUE(catalogue().parts());
  EXPECT_EQ(catalogue().parts()->at(0).losses, expected) << "a reason of a later version";
  ASSERT_TRUE(meddle("UPDATE parts SET losses = 'nonsense'"));
  ASSERT_TRUE(catalogue().parts());
  EXPECT_FALSE(catalogue().parts()->at(0).losses);
}

TEST_F(CatalogueSessions, UpdateOfWhatIsNotThere_IsNotFound) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "a"));
  EXPECT_EQ(code(catalogue().update_part({.session_id = "s1", .part = 2})), ErrorCode::NotFound);
  EXPECT_EQ(code(catalogue().update_part({.session_id = "s2"})), ErrorCode::NotFound);
  EXPECT_EQ(code(catalogue().end_session("s2", "complete", "", 1)), ErrorCode::NotFound);
  EXPECT_EQ(code(catalogue().session("s2")), ErrorCode::NotFound);
}

TEST_F(CatalogueSessions, AbsurdNumbers_AreRefused) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "a"));
  EXPECT_EQ(code(catalogue().update_part({.session_id = "s1", .scans = std::numeric_limits<std::uint64_t>::max()})),
            ErrorCode::LimitExceeded);
  EXPECT_EQ(code(catalogue().update_part({.session_id = "s1", .duration_s = std::nan("")})), ErrorCode::InvalidArgument);
  EXPECT_FALSE(catalogue().update_part({.session_id = "s1", .state = static_cast<PartState>(77)}));
  EXPECT_EQ(catalogue().session("s1")->parts[0].state, PartState::Recording);
}

TEST_F(CatalogueSessions, EndState_IsOneOfTheKnown) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "a"));
  for (const char* state : {"running", "", "done"})
    EXPECT_EQ(code(catalogue().end_session("s1", state, "", 1)), ErrorCode::InvalidArgument);
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
  ASSERT_TRUE(put(2, 6, "done", R"({"event":"result","segment":0,"scan":0,"class":2})"));

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

TEST_F(CatalogueSessions, BadTrial_IsRefused) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "f"));
  EXPECT_EQ(code(catalogue().put_trial({.session_id = "s1", .part = 2, .trial = 1, .outcome = "done"})), ErrorCode::NotFound);
  EXPECT_EQ(code(catalogue().put_trial({.session_id = "s1", .trial = 1, .outcome = "good"})), ErrorCode::InvalidArgument);
  EXPECT_EQ(code(catalogue().put_trial({.session_id = "s1", .trial = 0, .outcome = "done"})), ErrorCode::InvalidArgument);
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

TEST_F(CatalogueSessions, ResultThatIsNone_IsRefused) {
  ASSERT_TRUE(catalogue().begin_part(facts(), "f"));
  EXPECT_EQ(code(catalogue().put_result({.session_id = "s1", .name = "x", .value = std::nan("")})), ErrorCode::InvalidArgument);
  EXPECT_EQ(code(catalogue().put_result({.session_id = "none", .name = "x"})), ErrorCode::NotFound);
}

TEST_F(CatalogueSessions, Calibration_IsEnteredAgainWithoutHarm) {
  ASSERT_TRUE(catalogue().put_calibration("cop-1", "floor", "cop", "text"));
  EXPECT_TRUE(catalogue().put_calibration("cop-1", "floor", "cop", "text"));
}

TEST_F(CatalogueSessions, TooLongText_IsRefusedNotCut) {
  auto session = facts();
  session.protocol_definition = std::string(5U << 20U, 'x');
  EXPECT_EQ(code(catalogue().begin_part(session, "f")), ErrorCode::LimitExceeded);
  EXPECT_EQ(code(catalogue().session("s1")), ErrorCode::NotFound);
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

TEST_F(CatalogueSessions, Found_IsEnteredWholeOrNotAtAll) {
  FoundRecording found{.facts = facts(), .session_state = "complete", .ended_utc_ns = 5000};
  found.part = {.session_id = "s1", .file = "f", .state = PartState::Complete, .scans = 9};
  found.trials = {{.session_id = "s1", .trial = 1, .outcome = "done"}, {.session_id = "s1", .trial = 2, .outcome = "nonsense"}};
  EXPECT_EQ(code(catalogue().enter(found)), ErrorCode::InvalidArgument);
  EXPECT_EQ(code(catalogue().session("s1")), ErrorCode::NotFound);
  found.trials.pop_back();
  ASSERT_TRUE(catalogue().enter(found));
  EXPECT_EQ(catalogue().session("s1")->state, "complete");
  EXPECT_EQ(catalogue().session("s1")->ended_utc_ns, 5000);
  EXPECT_EQ(catalogue().session("s1")->trials.size(), 1U);
}

TEST_F(CatalogueSessions, FoundAgain_HasTheTrialsOfTheFileOnly) {
  FoundRecording found{.facts = facts(), .session_state = "complete"};
  found.part = {.session_id = "s1", .file = "f", .state = PartState::Complete};
  found.trials = {{.session_id = "s1", .trial = 1, .outcome = "done"}, {.session_id = "s1", .trial = 2, .outcome = "done"}};
  ASSERT_TRUE(catalogue().enter(found));
  found.trials.erase(found.trials.begin());
  ASSERT_TRUE(catalogue().enter(found));
  ASSERT_EQ(catalogue().session("s1")->trials.size(), 1U);
  EXPECT_EQ(catalogue().session("s1")->trials[0].trial, 2U);
}

TEST_F(CatalogueSessions, FoundOlderPart_LeavesTheSessionAsItIs) {
  ASSERT_TRUE(catalogue().begin_part(facts("s1", 2, 3000), "b"));
  ASSERT_TRUE(catalogue().end_session("s1", "aborted", "fell ill", 4000));
  FoundRecording found{.facts = facts("s1", 1, 1000), .session_state = "interrupted", .ended_utc_ns = 2000};
  found.part = {.session_id = "s1", .part = 1, .file = "a", .state = PartState::Interrupted};
  found.results = {{.session_id = "s1", .name = "eyes-open/MVELO", .value = 8.0, .unit = "mm/s"}};
  ASSERT_TRUE(catalogue().put_result({.session_id = "s1", .name = "eyes-open/MVELO_part_2", .value = 9.0, .unit = "mm/s", .details = ""}));
  ASSERT_TRUE(catalogue().enter(found));
  EXPECT_EQ(catalogue().results("s1")->size(), 2U) << "figures of both parts";
  const auto session = catalogue().session("s1");
  EXPECT_EQ(session->state, "aborted");
  EXPECT_EQ(session->message, "fell ill");
  EXPECT_EQ(session->started_utc_ns, 1000);
  EXPECT_EQ(session->ended_utc_ns, 4000);
  EXPECT_EQ(session->parts.size(), 2U);
}

TEST_F(CatalogueSessions, StateNames_AreAllDifferent) {
  std::vector<std::string_view> names;
  for (int state = 1; state <= 6; ++state) names.push_back(name(static_cast<PartState>(state)));
  EXPECT_THAT(names, ElementsAre("recording", "complete", "incomplete", "interrupted", "recovered", "missing"));
}

}  // namespace
}  // namespace dts::record
