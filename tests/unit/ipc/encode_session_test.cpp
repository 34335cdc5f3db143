// SPDX-License-Identifier: Apache-2.0
// What the catalogue and a session's state become on the wire: whole messages, every input with a value of its own.
#include "ipc/encode_session.h"

#include <gtest/gtest.h>

#include "dts/wire/event_json.h"
#include "ipc/command_handler.h"
#include "unit/ipc/message_text.h"

namespace dts::ipc {
namespace {

constexpr const char* kCut = "cut\xC3";               // in the middle of a character, as a limit of bytes cuts it
const std::string kClean = "\"cut\\357\\277\\275\"";  // NOLINT(cert-err58-cpp): U+FFFD in its place

TEST(EncodeSession, Record_IsWhatTheCatalogueKnows_WithEveryTextReadable) {
  core::Losses losses;
  losses.add(core::GapReason::Silence, {.gaps = 2, .scans = 40});
  record::SessionRow row{.id = "s1",
                         .rig = kCut,
                         .protocol = kCut,
                         .subject = kCut,
                         .label = kCut,
                         .state = "complete",
                         .message = kCut,
                         .started_utc_ns = 5,
                         .ended_utc_ns = 6};
  row.parts = {{.file = kCut,
                .state = record::PartState::Recovered,
                .sha256 = "abc",
                .bytes = 7,
                .scans = 8,
                .duration_s = 9,
                .losses = losses,
                .lost_s_at_most = 10,
                .reason = kCut,
                .valid_trials = 11},
               {.part = 2, .state = record::PartState::Complete},
               {.part = 3, .state = record::PartState::Recording},
               {.part = 4, .state = record::PartState::Complete, .losses = core::Losses()}};
  row.trials = {{.part = 2,
                 .trial = 3,
                 .attempt = 4,
                 .block = 5,
                 .condition = kCut,
                 .outcome = kCut,
                 .segment = 6,
                 .first_scan = 812,
                 .last_scan = 212,
                 .last_segment = 7}};

  EXPECT_EQ(text(session_record(row, 12)),
            "session_id: \"s1\" rig: " + kClean + " protocol: " + kClean + " subject: " + kClean + " label: " + kClean +
                " state: \"incomplete\" message: " + kClean +
                " started_utc_ns: 5 ended_utc_ns: 6 "
                "parts { part: 1 state: PART_STATE_RECOVERED file: " +
                kClean +
                " sha256: \"abc\" bytes: 7 scans: 8 duration_s: 9 "
                "lost_s_at_most: 10 reason: " +
                kClean +
                " losses { reason: GAP_REASON_SILENCE gaps_total: 2 lost_scans_total: 40 } valid_trials: 11 } "
                "parts { part: 2 state: PART_STATE_COMPLETE is_loss_unknown: true } "
                "parts { part: 3 state: PART_STATE_RECORDING } "
                "parts { part: 4 state: PART_STATE_COMPLETE } "
                "trials { part: 2 trial: 3 attempt: 4 block: 5 condition: " +
                kClean + " outcome: " + kClean + " segment: 6 first_scan: 812 last_scan: 212 last_segment: 7 } planned_trials: 12");
}

/// What a trial's stored event becomes.
std::string of_stored(const std::string& event) {
  record::SessionRow row{.id = "s1"};
  row.trials = {{.session_id = "s1", .trial = 4, .attempt = 2, .condition = kCut, .result = event}};
  dts::v1::TrialRecord trial = session_record(row, 0).trials(0);
  for (const char* beside : {"part", "trial", "attempt", "block", "condition"}) {
    trial.GetReflection()->ClearField(&trial, trial.GetDescriptor()->FindFieldByName(beside));
  }
  return text(trial);
}

TEST(EncodeSession, StoredResult_IsShownWhole) {
  const std::string reaching =
      "result { session_id: \"s1\" trial: 4 attempt: 2 condition: \"150\" target_cm: 80.5 reach { step: REACH_STEP_FINAL number: 3 p1 { "
      "scan: 600 value_mm: 3.5 } p2 { scan: 650 value_mm: 2.75 } p3 { scan: 800 value_mm: 5 } d1_mm: 0.75 flags: 16 } movement { number: 3 "
      "trunk_class: 2 probability: [0.125, 0.625, 0.25] trunk_deg: 30 trunk_lo_deg: 22 trunk_hi_deg: 38 reasons: 16 } expected_class: 3 "
      "is_at_end: true }";
  const std::string standing =
      "sway { session_id: \"s1\" trial: 4 attempt: 2 condition: \"eyes-open\" first_scan: 100 end_scan: 2100 rate_hz: 100 is_valid: true "
      "measures { symbol: \"MVELO_AP\" value: 5.25 unit: \"mm/s\" } }";
  EXPECT_EQ(of_stored(wire::to_json(message_of<v1::Event>("trial_" + reaching))), reaching);
  EXPECT_EQ(of_stored(wire::to_json(message_of<v1::Event>(standing))), standing);
}

TEST(EncodeSession, StoredResult_OfAnOlderCatalogueOrOfAStranger) {
  EXPECT_EQ(
      of_stored(R"({"event":"result","segment":0,"scan":0,"trial":4,"attempt":2,"condition":"150","target_cm":80.5,"expected_class":3,)"
                R"("number":7,"flags":17,"class":2,"trunk_deg":30,"trunk_lo_deg":22.5,"trunk_hi_deg":38,"reasons":16})"),
      "result { session_id: \"s1\" trial: 4 attempt: 2 condition: \"150\" target_cm: 80.5 reach { number: 7 flags: 17 } movement { number: "
      "7 trunk_class: 2 "
      "trunk_deg: 30 trunk_lo_deg: 22.5 trunk_hi_deg: 38 reasons: 16 } expected_class: 3 }");
  EXPECT_EQ(of_stored(R"({"event":"sway","segment":0,"scan":0,"trial":4,"is_valid":false})"),
            "sway { session_id: \"s1\" trial: 4 is_valid: false }");
  for (const char* none : {"", "{", R"({"event":"reach","segment":0,"scan":0,"step":"p1","number":1})",
                           R"({"event":"result","segment":0,"scan":0,"number":1,"flags":-1})", R"({"trial_result":{"reach":7}})"}) {
    EXPECT_EQ(of_stored(none), "") << none;
  }
}

TEST(EncodeSession, RowsBesideTheSession) {
  EXPECT_EQ(text(session_result({.session_id = "s1", .name = kCut, .value = 2.5, .unit = kCut, .details = kCut})),
            "name: " + kClean + " value: 2.5 unit: " + kClean + " details: " + kClean);
  EXPECT_EQ(text(audit_entry({.number = 1, .utc_ns = 2, .who = kCut, .what = kCut, .target = kCut, .result = kCut, .hash = "h"})),
            "number: 1 utc_ns: 2 who: " + kClean + " what: " + kClean + " target: " + kClean + " result: " + kClean + " hash: \"h\"");
  EXPECT_EQ(text(disk_status({.state = session::DiskState::Low, .free_bytes = 1, .recordable_s = 2, .directory = kCut, .problem = kCut})),
            "state: DISK_STATE_LOW free_bytes: 1 recordable_s: 2 directory: " + kClean + " problem: " + kClean);
  EXPECT_EQ(text(error_response({core::ErrorCode::NotFound, kCut, kCut})),
            "error { code: ERROR_CODE_NOT_FOUND what: " + kClean + " hint: " + kClean + " }");
}

TEST(EncodeSession, Protocol_NamesTrialsConditionsAndFields) {
  session::Protocol protocol{
      .name = "reach", .title = "Reaching", .sentence = "Reach out.", .rig_kind = "chair", .settle_s = 1, .duration_s = 2};
  protocol.fields = {
      {.name = "arm_length_cm", .label = "Arm length", .unit = "cm", .help = "Arm", .is_required = true, .minimum = 30, .maximum = 100},
      {.name = "group", .label = "Group", .choices = {"a", "b"}}};
  const std::string head = "name: \"reach\" sentence: \"Reach out.\" settle_s: 1 duration_s: 2 ";
  const std::string tail =
      "fields { name: \"arm_length_cm\" label: \"Arm length\" is_required: true minimum: 30 maximum: 100 unit: \"cm\" help: \"Arm\" } "
      "fields { name: \"group\" label: \"Group\" choices: \"a\" choices: \"b\" } rig_kind: \"chair\" title: \"Reaching\"";
  EXPECT_EQ(text(protocol_info(protocol)), head + tail + " length_s: 3");
  protocol.trials = session::TrialPlan{.conditions = {{.name = "80", .title = "Near", .target_percent = 80},
                                                      {.name = "max", .title = "Far", .is_maximum_reach = true},
                                                      {.name = "own-feedback", .title = "Own", .labels = {{"feedback", "cop"}}}},
                                       .trials_per_block = 3,
                                       .blocks = 4,
                                       .starts_by_itself = true,
                                       .settle_s = 5,
                                       .duration_s = 20};
  EXPECT_EQ(text(protocol_info(protocol)),
            head +
                "trials: 12 conditions { name: \"80\" title: \"Near\" settle_s: 5 duration_s: 20 target_percent: 80 } "
                "conditions { name: \"max\" title: \"Far\" settle_s: 5 duration_s: 20 is_maximum_reach: true } "
                "conditions { name: \"own-feedback\" title: \"Own\" settle_s: 5 duration_s: 20 has_feedback: true } " +
                tail + " length_s: 300 starts_by_itself: true");
}

TEST(EncodeSession, TrialOfASnapshot_IsEnoughForAClientThatConnectsNow) {
  session::TrialView view{.phase = session::TrialPhase::Waiting, .trial = 2, .attempt = 1, .of = 4, .condition = "b"};
  view.settle_s = 5;
  view.duration_s = 20;
  view.target_cm = 105;
  view.target_percent = 150;
  view.undo_s = 3.5;
  view.is_next_wanted = true;
  view.has_feedback = true;
  const std::string head =
      "phase: TRIAL_PHASE_WAITING trial: 2 attempt: 1 block: 1 of: 4 condition: \"b\" settle_s: 5 duration_s: 20 "
      "target_cm: 105 target_percent: 150 ";
  EXPECT_EQ(text(trial_status(view)), head + "undo_s: 3.5 is_next_wanted: true has_feedback: true");
  using enum session::TrialEventKind;
  for (const auto& [kind, word] : {std::pair{Done, "DONE"}, {Redone, "REDONE"}, {Rejected, "REJECTED"}, {Aborted, "ABORTED"}}) {
    view.last_ended = session::EndedAttempt{.outcome = kind, .trial = 2, .attempt = 3, .fault = v1::TRIAL_FAULT_STEPPED_OFF};
    EXPECT_EQ(text(trial_status(view)),
              head + "last_outcome: TRIAL_OUTCOME_" + word +
                  " last_trial: 2 last_attempt: 3 undo_s: 3.5 last_fault: TRIAL_FAULT_STEPPED_OFF is_next_wanted: true has_feedback: true");
  }
}

TEST(EncodeSession, FaultOfATrial_IsThatOfItsResult) {
  const auto fault = [](const std::string& outcome, const std::string& event) {
    record::SessionRow row{.id = "s1"};
    row.trials = {{.session_id = "s1", .trial = 4, .outcome = outcome, .result = wire::to_json(message_of<v1::Event>(event))}};
    return session_record(row, 0).trials(0).fault();
  };
  EXPECT_EQ(fault("done", "sway { trial: 4 is_valid: true }"), v1::TRIAL_FAULT_UNSPECIFIED);
  EXPECT_EQ(fault("done", "sway { trial: 4 is_valid: false flags: 2048 }"), v1::TRIAL_FAULT_STEPPED_OFF);
  EXPECT_EQ(fault("rejected", "sway { trial: 4 is_valid: false flags: 2048 }"), v1::TRIAL_FAULT_UNSPECIFIED);
  EXPECT_EQ(fault("done", "sway { trial: 4 is_valid: false flags: 4096 }"), v1::TRIAL_FAULT_FEET_MOVED);
  EXPECT_EQ(fault("done", "sway { trial: 4 problem: 'no samples' }"), v1::TRIAL_FAULT_NO_VALUES);
  EXPECT_EQ(fault("done", "trial_result { trial: 4 }"), v1::TRIAL_FAULT_NO_REACH);
  EXPECT_EQ(fault("done", "trial_result { trial: 4 target_cm: 53.6 expected_class: 0 }"), v1::TRIAL_FAULT_UNSPECIFIED)
      << "the target is at 80 % of the arm length: the arm alone hardly moves the seat";
  EXPECT_EQ(fault("done", "trial_result { trial: 4 target_cm: 80.4 expected_class: 1 }"), v1::TRIAL_FAULT_NO_REACH);
  EXPECT_EQ(fault("done", "trial_result { trial: 4 target_cm: 80.4 expected_class: 1 has_gap: true }"), v1::TRIAL_FAULT_NO_VALUES);
  EXPECT_EQ(fault("done", "trial_result { trial: 4 target_cm: 53.6 expected_class: 0 has_gap: true }"), v1::TRIAL_FAULT_NO_VALUES);
  EXPECT_EQ(fault("done", "trial_result { trial: 4 reach { number: 1 } }"), v1::TRIAL_FAULT_UNSPECIFIED);
}

TEST(EncodeSession, ProtocolOfASession_IsNamedOnlyOnceThereWasOne) {
  EXPECT_EQ(text(session_info("floor", {})), "rig: \"floor\" state: SESSION_STATE_IDLE");
}

TEST(EncodeSession, Plan_IsDoneByACompleteSessionWithAValidTrial) {
  RecordProperty("requirement", "SES-13");
  const auto session = [](const std::string& id, const std::string& protocol, std::uint32_t valid_trials) {
    record::SessionRow row{.id = id, .protocol = protocol, .state = "complete", .started_utc_ns = 20};
    row.parts = {{.state = record::PartState::Complete}, {.part = 2, .state = record::PartState::Complete, .valid_trials = valid_trials}};
    return row;
  };
  const auto planned_trials = [](const record::SessionRow& row) { return row.protocol == "free" ? 0U : 4U; };
  const auto done_by = [&](const std::string& protocol, const std::vector<record::SessionRow>& sessions) {
    v1::SubjectRecord subject;
    add_notes({.plan = {{.utc_ns = 10, .protocol = protocol}}}, sessions, planned_trials, subject);
    return subject.plan(0).session_id();
  };

  EXPECT_EQ(done_by("romberg", {session("stopped-at-once", "romberg", 0)}), "");
  EXPECT_EQ(done_by("romberg", {session("stopped-at-once", "romberg", 0), session("measured", "romberg", 1)}), "measured");
  EXPECT_EQ(done_by("free", {session("without-trials", "free", 0)}), "without-trials");
  auto early = session("early", "romberg", 1);
  early.started_utc_ns = 9;
  auto aborted = session("aborted", "romberg", 1);
  aborted.state = "aborted";
  EXPECT_EQ(done_by("romberg", {early, aborted, session("other", "quiet-standing", 1)}), "");
}

}  // namespace
}  // namespace dts::ipc
