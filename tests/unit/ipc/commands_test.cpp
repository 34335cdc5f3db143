// SPDX-License-Identifier: Apache-2.0
// Every command on a real rig: what it answers, and what the audit trail says of it.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "access/key_store.h"
#include "ipc/audit_trail.h"
#include "ipc/command_handler.h"
#include "unit/ipc/message_text.h"
#include "unit/session/recordings_fixture.h"

namespace dts::ipc {
namespace {

struct Row {
  std::string request;
  std::string answer;     ///< How its text begins, after the request's id.
  std::string entries{};  ///< New ones of the audit trail: who what [target] result.
};

std::string error(const std::string& code) { return "error { code: ERROR_CODE_" + code; }

std::string fields(int count) {
  std::string text;
  for (int field = 0; field < count; ++field) text += "fields { key: 'f" + std::to_string(field) + "' value: '1' } ";
  return text;
}

class CommandsTest : public session::RecordingsTest {
 protected:
  CommandsTest() : keys_(access::KeyStore::open(folder_.string() + "-keys").value()) {}
  ~CommandsTest() override { std::filesystem::remove_all(folder_.string() + "-keys"); }

  void make_handler() {
    handler_ = std::make_unique<CommandHandler>(
        *supervisor_, clock_, Identity{.instance_id = 42, .version = "1"}, std::vector<std::string>{"notice"},
        KeyCommands{keys_.get(), clock_, settings::RemoteEndpoints{.control = "tcp://c:1", .data = "tcp://d:2"}});
  }
  static void replace(std::string& text, const std::string& what, const std::string& by) {
    for (std::size_t at = 0; !what.empty() && (at = text.find(what, at)) != std::string::npos; at += by.size())
      text.replace(at, what.size(), by);
  }
  /// The answer to a request; the newest session is called ID in both.
  std::string ask(std::string request_text) {
    replace(request_text, "ID", session_id_);
    auto request = message_of<v1::Request>(request_text);
    request.set_request_id("q");
    CommandHandler::Answer answer = handler_->execute(request, author_of("local", request));
    if (answer.pending) {
      EXPECT_TRUE(eventually([&] {
        auto response = handler_->finish(*answer.pending);
        if (response) answer.response = *response;
        return response.has_value();
      })) << request_text;
    }
    if (answer.response.has_session()) session_id_ = answer.response.session().session_id();
    enter_audit(*supervisor_, clock_, "local", request, answer.response);
    if (!answer.pending) {
      EXPECT_EQ(answer.response.request_id(), "q");
    }
    answer.response.clear_request_id();
    std::string out = text(answer.response);
    replace(out, session_id_, "ID");
    replace(out, folder_.string(), "FOLDER");
    return out;
  }
  /// Entries of the audit trail since the last call.
  std::string new_entries() {
    const auto all = recordings_->catalogue().audit(1000).value();
    std::string out;
    for (; entries_ < all.size(); ++entries_) {
      const record::AuditEntry& entry = all[entries_];
      EXPECT_LT(std::abs(entry.utc_ns - clock_.now_ns() - clock_.utc_minus_monotonic_ns()), 60 * core::kNanosecondsPerSecond);
      out += (out.empty() ? "" : "; ") + entry.who + " " + entry.what + " " + (entry.target.empty() ? "" : "[" + entry.target + "] ") +
             entry.result;
    }
    replace(out, session_id_, "ID");
    return out;
  }
  void expect(const std::vector<Row>& rows) {
    for (const Row& row : rows) {
      const std::string answer = ask(row.request);
      EXPECT_EQ(answer.substr(0, row.answer.size()), row.answer) << row.request << "\n  " << answer;
      EXPECT_EQ(new_entries(), row.entries) << row.request;
    }
  }

  std::unique_ptr<access::KeyStore> keys_;
  std::unique_ptr<CommandHandler> handler_;
  std::string session_id_;
  std::size_t entries_ = 0;
};

TEST_F(CommandsTest, AbortWithAReasonAgainstTheRule_EndsTheSessionWithoutTheReason) {
  label_rule_.pattern = core::TextPattern::compile(session::kDefaultLabelPattern).value();
  start();
  make_handler();
  const auto abort = [&](const std::string& reason) {
    session_id_ = record(10);
    return ask("stop_session { is_abort: true reason: '" + reason + "' }");
  };
  const std::string left_out = abort("Subject fell. Anna Schmidt helped");
  EXPECT_NE(left_out.find("state: SESSION_STATE_IDLE"), std::string::npos) << left_out;
  EXPECT_NE(left_out.find("message: \"the reason does not follow this clinic\\'s rule for labels, so it is left out; enter it as notes: "
                          "dtsctl session edit ID --notes TEXT --reason TEXT\""),
            std::string::npos)
      << left_out;
  const std::string shown = ask("show_session { session_id: 'ID' }");
  EXPECT_NE(shown.find("state: \"aborted\""), std::string::npos);
  EXPECT_EQ(shown.find("Anna"), std::string::npos);

  EXPECT_EQ(abort("Subject fell. Stopped at once").find("message"), std::string::npos);
  EXPECT_NE(ask("show_session { session_id: 'ID' }").find("message: \"Subject fell. Stopped at once\""), std::string::npos);
}

TEST_F(CommandsTest, APlannedSessionIsDoneByASessionAndAnErasureRemovesNotesAndPlan) {
  start();
  make_handler();
  static_cast<void>(record(10, {.subject = "P1"}));
  ASSERT_TRUE(stop());
  static_cast<void>(record(10, {.subject = "P2"}));
  ASSERT_TRUE(stop());
  for (const char* edit : {"subject: 'P1' add_plan { protocol: 'free' }", "subject: 'P1' add_plan { protocol: 'free' }",
                           "subject: 'P1' add_note: 'New shoes'", "subject: 'P2' add_note: 'Like P1'"}) {
    ASSERT_NE(ask("edit_subject { " + std::string(edit) + " }").find("subject {"), std::string::npos) << edit;
  }
  static_cast<void>(record(10, {.subject = "P1"}));
  ASSERT_TRUE(stop());
  const auto subject = message_of<v1::Response>(ask("show_subject { subject: 'P1' }")).subject();
  ASSERT_EQ(subject.plan_size(), 2);
  EXPECT_NE(subject.plan(0).session_id(), "") << "the session after it";
  EXPECT_EQ(subject.plan(1).session_id(), "") << "one session does one planned session";
  EXPECT_EQ(subject.notes_size(), 1);

  ASSERT_NE(ask("erase_subject { subject: 'P1' }").find("erased { sessions: 2 "), std::string::npos);
  EXPECT_NE(ask("show_subject { subject: 'P1' }").find("NOT_FOUND"), std::string::npos);
  EXPECT_EQ(ask("list_subjects {}").find("P1"), std::string::npos);
  EXPECT_EQ(message_of<v1::Response>(ask("show_subject { subject: 'P2' }")).subject().notes(0).text(), "Like [erased]");
}

TEST_F(CommandsTest, ASubjectWithAFileIsShownUntilItIsErased) {
  start();
  make_handler();
  static_cast<void>(record(10, {.subject = "P1"}));
  ASSERT_TRUE(stop());
  ASSERT_NE(ask("edit_subject { subject: 'P1' add_note: 'New shoes' }").find("number: 1"), std::string::npos);
  ASSERT_NE(ask("edit_subject { subject: 'P1' remove_note: 1 }").find("subject {"), std::string::npos);
  EXPECT_NE(ask("edit_subject { subject: 'P1' add_note: 'Tired' }").find("number: 2"), std::string::npos) << "1 was used";
  ASSERT_NE(ask("edit_subject { subject: 'P1' remove_note: 2 }").find("subject {"), std::string::npos);
  const std::string file = folder_ / "sessions" / "subjects" / "P1.json";
  EXPECT_TRUE(std::filesystem::exists(file)) << "it has the next number";
  const auto session = recordings_->catalogue().sessions({.subject = "P1"}).value().front().id;
  ASSERT_NE(ask("correct_session { session_id: '" + session + "' subject: 'P2' reason: 'typing error' }").find("P2"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_EQ(ask("list_subjects {}").find("P1"), std::string::npos) << "a wrong subject ID without entries";

  const std::string left = folder_ / "sessions" / "subjects" / "P9.json.new";  // a crash left the first note of a subject unfinished
  std::ofstream(left) << "{";
  EXPECT_NE(ask("list_subjects {}").find("P9"), std::string::npos);
  const std::string shown = ask("show_subject { subject: 'P9' }");
  EXPECT_NE(shown.find("subject: \"P9\""), std::string::npos) << shown;
  EXPECT_NE(ask("show_subject { subject: 'P8' }").find("NOT_FOUND"), std::string::npos);
  ASSERT_NE(ask("erase_subject { subject: 'P9' }").find("erased { files: 1 "), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(left));
  EXPECT_NE(ask("show_subject { subject: 'P9' }").find("NOT_FOUND"), std::string::npos);
}

TEST_F(CommandsTest, OnARigThatStreams) {
  session::Protocol stand{.name = "stand"};
  stand.fields = {{.name = "age", .minimum = 1, .maximum = 100}};
  stand.trials = session::TrialPlan{.conditions = {{.name = "a"}}, .trials_per_block = 3};
  start({session::Protocol{}, stand});
  make_handler();
  ASSERT_TRUE(eventually([&] { return supervisor_->test_device("floor").has_value(); }));
  static_cast<void>(new_entries());
  const std::string started =
      "session { session_id: \"ID\" rig: \"floor\" state: SESSION_STATE_STARTING protocol: \"stand\" subject: \"P7\" label: \"L\" "
      "duration_s: ";
  const std::string start =
      "start_session { rig: 'floor' protocol: 'stand' subject: 'P7' label: 'L' duration_s: 100 fields { key: 'age' value: '7' } }";
  expect({
      {"", error("INVALID_ARGUMENT")},
      {"status {}", "status { instance_id: 42 version: \"1\""},
      {"list_rigs {}", "rigs { rigs { name: \"floor\""},
      {"list_protocols {}", "protocols { protocols { name: \"free\" } protocols { name: \"stand\" trials: 3"},
      {"get_devices {}", "devices { devices { rig: \"floor\" uri: \"hand:fed\" model: "},
      {"list_sessions {}", "sessions { }"},
      {"show_session { session_id: 'x' }", error("NOT_FOUND")},
      {"mark { text: 'x' }", "mark { marks { rig: \"floor\" scan: ", "local mark ok"},
      {"mark { text: 'x' rig: 'floor' }", "mark { marks { rig: \"floor\" scan: ", "local mark [floor] ok"},
      {"mark { text: 'x' rig: 'chair' }", error("NOT_FOUND"), "local mark not_found"},
      {"mark { rig: 'floor' }", error("INVALID_ARGUMENT"), "local mark [floor] invalid_argument"},
      {"tare { rig: 'chair' }", error("NOT_FOUND"), "local tare not_found"},
      {"tare { rig: 'floor' }", error("WRONG_STATE") + " what: \"tare rejected: the plate of rig \\'floor\\' is loaded\"",
       "local tare [floor] wrong_state"},
      {"test_device { rig: 'chair' }", error("NOT_FOUND"), "local device_test not_found"},
      {"stop_session {}", error("WRONG_STATE"), "local stop_session wrong_state"},
      {"stop_session { rig: 'chair' is_abort: true }", error("NOT_FOUND"), "local abort_session not_found"},
      {"resume_session { session_id: 'x' }", error("NOT_FOUND"), "local resume_session not_found"},
      {"trial {}", error("INVALID_ARGUMENT"), "local trial invalid_argument"},
      {"trial { action: TRIAL_ACTION_NEXT }", error("WRONG_STATE"), "local trial_next wrong_state"},
      {"start_session { rig: 'chair' }", error("NOT_FOUND"), "local start_session not_found"},
      {"start_session { rig: 'floor' }",
       error("INVALID_ARGUMENT") +
           " what: \"a session needs a protocol, and none is given\" hint: \"add --protocol NAME, one of: free, stand\"",
       "local start_session [floor] invalid_argument"},
      {"start_session { rig: 'floor' subject: 'Jane Doe' }", error("INVALID_ARGUMENT"), "local start_session [floor] invalid_argument"},
      {"start_session { rig: 'floor' duration_s: -1 }", error("INVALID_ARGUMENT"), "local start_session [floor] invalid_argument"},
      {"start_session { rig: 'floor' settle_s: -1 }", error("INVALID_ARGUMENT"), "local start_session [floor] invalid_argument"},
      {"start_session { rig: 'floor' protocol: 'free' " + fields(65) + "}", error("LIMIT_EXCEEDED"),
       "local start_session [floor] limit_exceeded"},
      {"start_session { rig: 'floor' protocol: 'free' " + fields(64) + "}", error("INVALID_ARGUMENT"),
       "local start_session [floor] invalid_argument"},
      {start, started, "local start_session [ID] ok"},
  });
  ASSERT_TRUE(is_in(session::SessionState::Running));
  const std::string trial = "trial { phase: TRIAL_PHASE_";
  expect({
      {start, error("WRONG_STATE"), "local start_session [ID] wrong_state"},
      {"tare { rig: 'floor' }", error("WRONG_STATE"), "local tare [ID] wrong_state"},
      {"mark { text: 'x' }", "mark { marks { rig: \"floor\" scan: ", "local mark [ID] ok"},
      {"trial { action: TRIAL_ACTION_NEXT }",
       trial + "MEASURING trial: 1 attempt: 1 block: 1 of: 3 condition: \"a\" next_condition: \"a\" next_trial: 2 }", "local trial_next [ID] ok"},
      {"trial { action: TRIAL_ACTION_REDO }", trial + "MEASURING trial: 1 attempt: 2", "local trial_redo [ID] ok"},
      {"trial { action: TRIAL_ACTION_NEXT rig: 'floor' }", trial + "WAITING trial: 1 attempt: 2", "local trial_next [ID] ok"},
      {"trial { action: TRIAL_ACTION_REJECT }", trial + "WAITING trial: 1", "local trial_reject [ID] ok"},
      {"trial { action: TRIAL_ACTION_UNDO }", trial + "WAITING trial: 1", "local trial_undo [ID] ok"},
      {"trial { action: TRIAL_ACTION_UNDO }", error("WRONG_STATE"), "local trial_undo [ID] wrong_state"},
      {"stop_session { is_abort: true reason: 'tired' }",
       "session { session_id: \"ID\" rig: \"floor\" state: SESSION_STATE_IDLE protocol: \"stand\" subject: \"P7\"",
       "local abort_session [ID] ok"},
      {"show_session { session_id: 'ID' }",
       "session_record { session_id: \"ID\" rig: \"floor\" protocol: \"stand\" subject: \"P7\" label: \"L\" state: \"aborted\" message: "
       "\"tired\" started_utc_ns: "},
      {"resume_session { session_id: 'ID' }", started, "local resume_session [ID] ok"},
      {"stop_session { rig: 'floor' }", "session { session_id: \"ID\"", "local stop_session [ID] ok"},
  });
  EXPECT_NE(ask("show_session { session_id: 'ID' }").find("fields { key: \"age\" value: \"7\" }"), std::string::npos);
  const auto fields_in_subject = [this] {
    return message_of<v1::Response>(ask("show_subject { subject: 'P7' with_results: true }")).subject().sessions(0).fields();
  };
  EXPECT_TRUE(fields_in_subject().empty());
  const auto set = supervisor_->recordings().catalogue().set_results(
      session_id_, {{.session_id = session_id_, .name = "targets_part_2", .value = 1, .unit = "1", .details = "{}"}});
  ASSERT_TRUE(set) << set.error().what;
  EXPECT_EQ(fields_in_subject()["age"], "7") << "trends need to know which arm reached";
  static_cast<void>(record(10));
  expect({{"stop_session {}", "session { session_id: \"ID\" rig: \"floor\" state: SESSION_STATE_IDLE protocol: \"free\"",
           "local stop_session [ID] ok"}});
  expect({
      {"correct_session { session_id: 'ID' subject: 'P9' reason: 'typo' } on_behalf_of: 'anna'",
       "session_record { session_id: \"ID\" rig: \"floor\" protocol: \"free\" subject: \"P9\"", "local:anna correct_session [ID] ok"},
      {"correct_session { session_id: 'ID' subject: 'P9' reason: 'typo' }", error("INVALID_ARGUMENT"),
       "local correct_session [ID] invalid_argument"},
      {"correct_session { session_id: 'Jane Doe' subject: 'P9' reason: 'typo' }", error("NOT_FOUND"), "local correct_session not_found"},
      {"delete_session { session_id: 'ID' reason: 'test' }", "session_record { session_id: \"ID\"", "local delete_session [ID] ok"},
      {"list_sessions { deleted: true }", "sessions { sessions { session_id: \"ID\""},
      {"delete_session { session_id: 'ID' is_restore: true }", "session_record { session_id: \"ID\"", "local restore_session [ID] ok"},
      {"list_sessions { deleted: true }", "sessions { }"},
      {"list_subjects {}", "subjects { subjects { subject: \"P7\" sessions: 1 "},
      {"show_subject { subject: 'P9' }", "subject { about { subject: \"P9\" sessions: 1 "},
      {"show_subject { subject: 'Jane Doe' }", error("NOT_FOUND")},
      {"show_subject {}", error("NOT_FOUND")},
      {"edit_subject { subject: 'P9' }", error("INVALID_ARGUMENT"), "local edit_subject invalid_argument"},
      {"edit_subject { subject: 'Jane Doe' add_note: 'tired' }", error("NOT_FOUND"), "local edit_subject [note added] not_found"},
      {"edit_subject { subject: 'P9' add_note: 'two\\nlines' }", error("INVALID_ARGUMENT"),
       "local edit_subject [note added] invalid_argument"},
      {"edit_subject { subject: 'P9' add_note: 'Walks with a stick' } on_behalf_of: 'anna'",
       "subject { about { subject: \"P9\" sessions: 1 ", "local:anna edit_subject [note added] ok"},
      {"edit_subject { subject: 'P9' add_plan { protocol: 'stand' due_date: '2026-02-30' } }", error("INVALID_ARGUMENT"),
       "local edit_subject [session planned] invalid_argument"},
      {"edit_subject { subject: 'P9' add_plan { protocol: 'hop' } }", error("NOT_FOUND"), "local edit_subject [session planned] not_found"},
      {"edit_subject { subject: 'P9' add_plan { protocol: 'free' due_date: '2026-12-31' } }", "subject { about { subject: \"P9\" ",
       "local edit_subject [session planned] ok"},
      {"edit_subject { subject: 'P9' remove_note: 7 }", error("NOT_FOUND"), "local edit_subject [note removed] not_found"},
      {"erase_subject { subject: 'Jane Doe' }", error("NOT_FOUND"), "local erase_subject not_found"},
      {"erase_subject {}", error("NOT_FOUND"), "local erase_subject not_found"},
  });
  const auto corrected = message_of<v1::Response>(ask("show_session { session_id: 'ID' }")).session_record();
  ASSERT_EQ(corrected.corrections_size(), 3);
  EXPECT_EQ(corrected.corrections(0).who() + " " + corrected.corrections(0).new_value(), "local:anna P9");
  const auto in_list = message_of<v1::Response>(ask("list_sessions { subject: 'P9' }")).sessions().sessions(0);
  ASSERT_EQ(in_list.corrections_size(), 3);
  EXPECT_EQ(in_list.corrections(0).new_value() + in_list.corrections(0).reason(), "") << "lists have no texts";
  const auto noted = message_of<v1::Response>(ask("show_subject { subject: 'P9' with_results: true }")).subject();
  ASSERT_EQ(noted.notes_size(), 1);
  EXPECT_EQ(noted.notes(0).who() + " " + noted.notes(0).text(), "local:anna Walks with a stick");
  ASSERT_EQ(noted.plan_size(), 1);
  EXPECT_EQ(noted.plan(0).protocol() + " " + noted.plan(0).due_date() + " " + noted.plan(0).session_id(), "free 2026-12-31 ")
      << "the session is older than the plan";
  EXPECT_EQ(noted.about().rigs(0), "floor");
  const auto unplanned = message_of<v1::Response>(ask("edit_subject { subject: 'P9' remove_plan: 2 }")).subject();
  EXPECT_EQ(unplanned.plan_size(), 0);
  static_cast<void>(record(10, {.subject = "P55"}));
  ASSERT_TRUE(stop());
  static_cast<void>(new_entries());
  expect(
      {{"erase_subject { subject: 'P55' } on_behalf_of: 'ina'", "erased { sessions: 1 files: 2 ", "local:ina erase_subject [1 session] ok"},
       {"show_subject { subject: 'P55' }", error("NOT_FOUND")}});
  EXPECT_EQ(message_of<v1::Response>(ask("status {}")).status().erasures_total(), 1U);
  const auto listed = [&](const std::string& filter) {
    return message_of<v1::Response>(ask("list_sessions { " + filter + " }")).sessions().sessions_size();
  };
  EXPECT_EQ(listed(""), 2);
  EXPECT_EQ(listed("limit: 1"), 1);
  EXPECT_EQ(listed("limit: 4000000000"), 2);
  EXPECT_EQ(listed("rig: 'floor'"), 2);
  for (const char* one : {"subject: 'P7'", "protocol: 'stand'", "protocol: 'free'"}) EXPECT_EQ(listed(one), 1) << one;
  for (const char* none : {"rig: 'chair'", "subject: 'P8'", "protocol: 'P7'"}) EXPECT_EQ(listed(none), 0) << none;
  const auto audit = message_of<v1::Response>(ask("get_audit { limit: 2 }")).audit();
  EXPECT_EQ(audit.entries_size(), 2);
  EXPECT_EQ(audit.verified_entries(), entries_);
  EXPECT_EQ(audit.problem(), "");

  const auto test = message_of<v1::Response>(ask("test_device { rig: 'floor' }")).device_test();
  EXPECT_EQ(new_entries(), "") << "a look, which succeeded";
  const auto tested = supervisor_->test_device("floor").value();
  ASSERT_EQ(test.channels_size(), static_cast<int>(supervisor_->rigs().front()->device().channels.size()));
  for (int index = 0; index < test.channels_size(); ++index) {
    const auto& channel = test.channels(index);
    const bool is_sensor = index < 4;
    EXPECT_EQ(channel.name(), supervisor_->rigs().front()->device().channels[static_cast<std::size_t>(index)].name);
    EXPECT_EQ(channel.unit(), supervisor_->rigs().front()->device().channels[static_cast<std::size_t>(index)].unit);
    EXPECT_LE(channel.minimum(), channel.mean());
    EXPECT_LE(channel.mean(), channel.maximum());
    EXPECT_EQ(channel.is_sensor(), is_sensor);
    EXPECT_EQ(channel.gap_mm(), is_sensor ? supervisor_->rigs().front()->config().model.sensors[0].curve.gap({channel.mean()}).value : 0.0);
    EXPECT_EQ(channel.quality(), 0U) << "someone of usual weight is within the working range";
  }
  EXPECT_GT(test.scans(), 0U);
  EXPECT_GT(test.measured_rate_hz(), 0.0);
  EXPECT_EQ(test.firmware(), tested.report.firmware);
  EXPECT_EQ(static_cast<std::size_t>(test.checks_size()), tested.report.checks.size());
}

TEST_F(CommandsTest, OnKeysAndLogins) {
  open();
  make_handler();
  const std::string key(40, 'a');
  const std::string all_keys = "server_public_key: \"" + keys_->server().public_key;
  const std::string none = "keys { " + all_keys;
  const std::string refused = error("INVALID_ARGUMENT");
  expect({
      {"list_keys {}", none},
      {"add_key { name: 'anna' role: ROLE_OPERATOR public_key: '" + key + "' }",
       "keys { keys { name: \"anna\" role: ROLE_OPERATOR public_key: \"" + key + "\" created_utc: \"20",
       "local key_new [anna:operator] ok"},
      {"add_key { name: 'anna' role: ROLE_VIEWER public_key: '" + key + "' }", error("WRONG_STATE"),
       "local key_new [anna:viewer] wrong_state"},
      {"add_key { name: 'Jane Doe' role: ROLE_VIEWER }", refused, "local key_new invalid_argument"},
      {"revoke_key { name: 'Jane Doe' }", error("NOT_FOUND"), "local key_revoke not_found"},
      {"revoke_key { name: 'anna' } on_behalf_of: 'otto'", none, "local:otto key_revoke [anna] ok"},
      {"revoke_key { name: 'anna' } on_behalf_of: 'Otto Z'", error("NOT_FOUND"), "local key_revoke [anna] not_found"},
      {"note_login { user: 'anna' address: '192.0.2.7' }", "note_login { }", "local login [anna from 192.0.2.7] ok"},
      {"note_login { address: '2001:db8::7' more: 1 is_refused: true }", "note_login { }",
       "local login [unknown name from 2001:db8::7, and 1 more] refused"},
      {"note_login { address: '" + std::string(64, 'z') + "' }", "note_login { }",
       "local login [unknown name from " + std::string(64, 'z') + "] ok"},
      {"note_login { address: '" + std::string(65, 'z') + "' }", refused, "local login invalid_argument"},
      {"note_login { user: 'anna' }", refused, "local login invalid_argument"},
      {"note_login { user: 'anna' address: '192.0.2.7 anna' }", refused, "local login invalid_argument"},
      {"note_login { user: 'Jane Doe' address: '192.0.2.7' }", refused, "local login invalid_argument"},
  });
  EXPECT_TRUE(ask("list_keys {}").ends_with("control_endpoint: \"tcp://c:1\" data_endpoint: \"tcp://d:2\" }"));
  handler_ = std::make_unique<CommandHandler>(*supervisor_, clock_, Identity{}, std::vector<std::string>{},
                                              KeyCommands{nullptr, clock_, std::nullopt, {core::ErrorCode::DataDamaged, "damaged", ""}});
  for (const char* command : {"list_keys {}", "add_key { name: 'b' }", "revoke_key { name: 'b' }"}) {
    EXPECT_EQ(ask(command), error("DATA_DAMAGED") + " what: \"damaged\" }");
  }
}

TEST_F(CommandsTest, Tare_IsAnsweredOnceItsOwnReportIsThere) {
  open();
  make_handler();
  using pipeline::TareOutcome;
  const auto answer = [&](const pipeline::TareReport& report) {
    supervisor_->rigs().front()->tare().report(report);
    const auto response = handler_->finish(PendingTare{.rig = "floor", .request = 2});
    return response ? text(*response) : "not yet";
  };
  EXPECT_EQ(answer({.request = 1, .outcome = TareOutcome::Done}), "not yet") << "that of another request";
  EXPECT_EQ(answer({.request = 2, .outcome = TareOutcome::Running}), "not yet");
  EXPECT_EQ(answer({.request = 2, .outcome = TareOutcome::None}), "not yet");
  for (const std::uint64_t request : {2U, 3U}) {
    EXPECT_EQ(answer({.request = request, .outcome = TareOutcome::Done, .channel_count = 3, .baseline = {0.5, 0.25, 2}}),
              "tare { baseline: [0.5, 0.25, 2] unit: \"mm\" }");
  }
  EXPECT_EQ(answer({.request = 2, .outcome = TareOutcome::Done, .channel_count = 1, .unit = pipeline::ZeroUnit::Volts, .baseline = {0.5}}),
            "tare { baseline: [0.5] unit: \"V\" }");
  const std::string refused = error("WRONG_STATE") + " what: \"tare rejected: ";
  EXPECT_TRUE(answer({.request = 2, .outcome = TareOutcome::Loaded}).starts_with(refused + "the plate of rig \\'floor\\' is loaded"));
  EXPECT_TRUE(answer({.request = 2, .outcome = TareOutcome::Unsteady}).starts_with(refused + "the plate of rig \\'floor\\' moved"));
  EXPECT_TRUE(answer({.request = 2, .outcome = TareOutcome::BadSensor}).starts_with(refused + "a sensor of rig \\'floor\\' is faulty"));
  EXPECT_EQ(handler_->finish(PendingTare{.rig = "chair", .request = 2})->error().code(), v1::ERROR_CODE_NOT_FOUND);

  EXPECT_TRUE(text(handler_->give_up(PendingTare{.rig = "floor", .request = 2})).starts_with(error("TIMEOUT")));
  EXPECT_TRUE(supervisor_->rigs().front()->tare().is_cancelled(2)) << "it must not happen later, unasked";
  EXPECT_TRUE(text(handler_->give_up(PendingStop{.rig = "floor", .session_id = "s1"}))
                  .starts_with(error("TIMEOUT") + " what: \"the recording of session s1"));
  EXPECT_EQ(handler_->finish(PendingStop{.rig = "chair", .session_id = "s1"})->error().code(), v1::ERROR_CODE_NOT_FOUND);
}

TEST_F(CommandsTest, TareOfAChair_NamesItsSeat) {
  config_.kind = "chair";
  open();
  make_handler();
  using pipeline::TareOutcome;
  const auto answer = [&](TareOutcome outcome) {
    supervisor_->rigs().front()->tare().report({.request = 2, .outcome = outcome});
    return text(*handler_->finish(PendingTare{.rig = "floor", .request = 2}));
  };
  const std::string refused = error("WRONG_STATE") + " what: \"tare rejected: the seat of rig \\'floor\\' ";
  EXPECT_EQ(answer(TareOutcome::Loaded), refused + "is loaded\" hint: \"let the subject stand up, clear the seat, then try again\" }");
  EXPECT_EQ(answer(TareOutcome::Unsteady), refused + "moved while averaging\" hint: \"keep still around the seat, then try again\" }");
}

TEST_F(CommandsTest, Status_CountsAndWarns) {
  open();
  make_handler();
  handler_->count_rejected();
  const v1::StatusSnapshot status = handler_->status();
  EXPECT_EQ(status.rejected_requests_total(), 1U);
  EXPECT_TRUE(status.has_network());
  EXPECT_EQ(status.disk().directory(), recordings_->disk().directory);
}

}  // namespace
}  // namespace dts::ipc
