// SPDX-License-Identifier: Apache-2.0
#include "dts/control_client.h"

#include <gtest/gtest.h>

#include <limits>
#include <mutex>
#include <set>

#include "../clients/libdts/wire_check.h"
#include "unit/libdts/fake_daemon.h"

namespace dts::client {
namespace {

using testing::FakeController;
using testing::reply;

class ControlClientTest : public ::testing::Test {
 protected:
  /// Retries come after 0.2 s; a command that must succeed has a minute.
  ControlClient client(std::chrono::milliseconds timeout = testing::kDeadline, int tries = 3) {
    return *ControlClient::open({.endpoint = endpoint_, .timeout = timeout, .tries = tries});
  }

  testing::TemporaryDirectory directory_;
  std::string endpoint_ = directory_.endpoint("control.sock");
};

std::vector<std::string> answer_status(const v1::Request& request, int) {
  return {reply(request, [](v1::Response& response) { *response.mutable_status() = testing::floor_status(); })};
}

TEST_F(ControlClientTest, SeveralCommands_EachHasItsOwnRequestId) {
  std::mutex mutex;
  std::set<std::string> ids;
  const FakeController daemon(endpoint_, [&](const v1::Request& request, int number) {
    const std::lock_guard lock(mutex);
    ids.insert(request.request_id());
    return answer_status(request, number);
  });
  ControlClient dts = client();

  for (int command = 0; command < 3; ++command) EXPECT_EQ(dts.status()->rigs(0).rig().name(), "floor");

  const std::lock_guard lock(mutex);
  EXPECT_EQ(ids.size(), 3U);
  for (const std::string& id : ids) {
    EXPECT_EQ(id.size(), 32U);
    EXPECT_EQ(id.find_first_not_of("0123456789abcdef"), std::string::npos) << id;
  }
}

TEST_F(ControlClientTest, FirstReplyLost_SameRequestIsSentAgainAndExecutedOnce) {
  RecordProperty("requirement", "PUB-7");
  std::set<std::string> executed;
  int resent = 0;
  {
    const FakeController daemon(endpoint_, [&](const v1::Request& request, int number) {
      if (!executed.insert(request.request_id()).second) ++resent;
      if (number == 0) return std::vector<std::string>{};
      return std::vector{reply(request, [](v1::Response& response) { response.mutable_session()->set_session_id("s1"); })};
    });
    v1::StartSessionRequest request;
    request.set_rig("floor");

    const auto session = client(std::chrono::milliseconds(4000), 2).start_session(request);

    ASSERT_TRUE(session.has_value());
    EXPECT_EQ(session->session_id(), "s1");
  }
  EXPECT_EQ(executed.size(), 1U);
  EXPECT_GE(resent, 1);
}

TEST_F(ControlClientTest, NeverAnswered_UnreachableAfterTheGivenTries) {
  const FakeController daemon(endpoint_, [](const v1::Request&, int) { return std::vector<std::string>{}; });

  const auto status = client(std::chrono::milliseconds(949), 3).status();

  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code, ErrorCode::Unreachable);
  EXPECT_EQ(status.error().what, "no answer from " + endpoint_ + " within 0.9 s (3 tries)");
  EXPECT_FALSE(status.error().hint.empty());
  EXPECT_LE(daemon.requests(), 3);
}

TEST_F(ControlClientTest, NobodyListens_UnreachableAtOnce) {
  const auto status = client(std::chrono::hours(1)).status();

  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code, ErrorCode::Unreachable);
}

TEST_F(ControlClientTest, GarbageAndForeignRepliesBeforeTheAnswer_AreIgnoredAndCounted) {
  const FakeController daemon(endpoint_, [](const v1::Request& request, int number) {
    v1::Request other = request;
    other.set_request_id("another");
    return std::vector<std::string>{"", "\xff\xff garbage", answer_status(other, 0).front(), answer_status(request, number).front()};
  });
  ControlClient dts = client();

  const auto status = dts.status();

  ASSERT_TRUE(status.has_value());
  EXPECT_EQ(dts.ignored_replies(), 3U);
}

TEST_F(ControlClientTest, OnlyGarbage_ErrorSaysThatSomethingElseListens) {
  const FakeController daemon(endpoint_, [](const v1::Request&, int) { return std::vector<std::string>{"HTTP/1.1 400 Bad Request"}; });

  // The client waits to the end: longer where the fake daemon did not get its turn.
  auto status = client(std::chrono::milliseconds(600)).status();
  for (auto timeout = std::chrono::milliseconds(2000); !status && timeout < testing::kDeadline; timeout *= 4) {
    if (status.error().what.find("no valid answer") != std::string::npos) break;
    status = client(timeout).status();
  }

  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code, ErrorCode::Unreachable);
  EXPECT_NE(status.error().what.find("no valid answer"), std::string::npos);
}

TEST_F(ControlClientTest, OversizedReply_IsIgnoredAndTheLargestArrives) {
  const FakeController daemon(endpoint_, [](const v1::Request& request, int) {
    v1::Response large;
    large.set_request_id(request.request_id());
    large.mutable_sessions()->add_sessions()->set_session_id("s1");
    std::string& label = *large.mutable_sessions()->mutable_sessions(0)->mutable_label();
    label.assign(kMaxAnswerBytes - 100, 'x');
    label.append(kMaxAnswerBytes - large.ByteSizeLong(), 'x');
    const std::string largest = large.SerializeAsString();
    label += 'x';
    return std::vector{large.SerializeAsString(), largest};
  });
  ControlClient dts = client();

  EXPECT_TRUE(dts.list_sessions().has_value());
  EXPECT_EQ(dts.ignored_replies(), 1U);
}

TEST_F(ControlClientTest, ReplyBeyondTheSocketsLimit_PeerIsDroppedAndUnreachable) {
  const FakeController daemon(endpoint_, [](const v1::Request&, int) { return std::vector{std::string(20U << 20U, 'x')}; });

  const auto status = client(std::chrono::milliseconds(1060)).status();

  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code, ErrorCode::Unreachable);
  EXPECT_EQ(status.error().what, "no answer from " + endpoint_ + " within 1.1 s (3 tries)") << "not counted as a wrong answer";
}

TEST_F(ControlClientTest, DaemonRefuses_CodeReasonAndHintArrive) {
  const FakeController daemon(endpoint_, [](const v1::Request& request, int) {
    return std::vector{reply(request, [](v1::Response& response) {
      response.mutable_error()->set_code(v1::ERROR_CODE_WRONG_STATE);
      response.mutable_error()->set_what("floor has a session");
      response.mutable_error()->set_hint("stop it first");
    })};
  });

  const auto session = client().stop_session("floor");

  ASSERT_FALSE(session.has_value());
  EXPECT_EQ(session.error(), (Error{ErrorCode::WrongState, "floor has a session", "stop it first"}));
}

TEST_F(ControlClientTest, DaemonRefusesWithUnknownCodeOrEndlessText_FailedAndCut) {
  const FakeController daemon(endpoint_, [](const v1::Request& request, int number) {
    return std::vector{reply(request, [number](v1::Response& response) {
      response.mutable_error()->set_code(static_cast<v1::ErrorCode>(99));
      response.mutable_error()->set_what(std::string(static_cast<std::size_t>(number) * 2001, 'x'));
      response.mutable_error()->set_hint(std::string(2001, 'y'));
    })};
  });
  ControlClient dts = client();

  EXPECT_EQ(dts.stop_session("floor").error(),
            (Error{ErrorCode::Failed, "the daemon rejected the command and gave no reason", std::string(2000, 'y')}));
  EXPECT_EQ(dts.stop_session("floor").error().what, std::string(2000, 'x'));
}

TEST_F(ControlClientTest, RefusalWithoutRequestId_IsTheAnswer) {
  const FakeController daemon(endpoint_, [](const v1::Request&, int) {
    v1::Response response;
    response.mutable_error()->set_code(v1::ERROR_CODE_INVALID_ARGUMENT);
    response.mutable_error()->set_what("the message is not a dts.v1.Request");
    return std::vector{response.SerializeAsString()};
  });

  const auto status = client().status();

  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code, ErrorCode::InvalidArgument);
}

/// What a command sends, and an answer that belongs to it.
struct Command {
  std::string request;
  std::string answer;
  std::function<std::string(ControlClient&)> call;  ///< Nothing: it can only be passed on.
};

std::string text_of(google::protobuf::Message&& message) {
  google::protobuf::TextFormat::Printer printer;
  printer.SetSingleLineMode(true);
  std::string text;
  printer.PrintToString(message, &text);
  return text;
}

template <class Answer>
std::string text_of(Result<Answer>&& answer) {
  return answer ? text_of(std::move(*answer)) : answer.error().what;
}

std::vector<Command> commands() {
  using Client = ControlClient;
  using testing::from_text;
  return {
      {"status { }", "status { instance_id: 7 }", [](Client& dts) { return text_of(dts.status()); }},
      {"list_rigs { }", "rigs { rigs { name: \"floor\" } }", [](Client& dts) { return text_of(dts.list_rigs()); }},
      {"start_session { rig: \"floor\" fields { key: \"a\" value: \"b\" } }", "session { session_id: \"s1\" }",
       [](Client& dts) {
         return text_of(dts.start_session(from_text<v1::StartSessionRequest>("rig: 'floor' fields { key: 'a' value: 'b' }")));
       }},
      {"stop_session { rig: \"floor\" }", "session { session_id: \"s2\" }", [](Client& dts) { return text_of(dts.stop_session("floor")); }},
      {"stop_session { is_abort: true reason: \"dizzy\" }", "session { session_id: \"s3\" }",
       [](Client& dts) { return text_of(dts.stop_session(from_text<v1::StopSessionRequest>("is_abort: true reason: 'dizzy'"))); }},
      {"resume_session { session_id: \"s4\" }", "session { session_id: \"s4\" }",
       [](Client& dts) { return text_of(dts.resume_session("s4")); }},
      {"mark { text: \"hello\" rig: \"floor\" }", "mark { marks { rig: \"floor\" scan: 5 } }",
       [](Client& dts) { return text_of(dts.mark("hello", "floor")); }},
      {"tare { rig: \"floor\" }", "tare { baseline: 9.5 }", [](Client& dts) { return text_of(dts.tare("floor")); }},
      {"get_devices { }", "devices { kinds: \"sim:floor\" }", [](Client& dts) { return text_of(dts.devices()); }},
      {"test_device { rig: \"chair\" }", "device_test { scans: 7 }", [](Client& dts) { return text_of(dts.test_device("chair")); }},
      {"list_sessions { subject: \"P017\" }", "sessions { sessions { session_id: \"s5\" } }",
       [](Client& dts) { return text_of(dts.list_sessions(from_text<v1::ListSessionsRequest>("subject: 'P017'"))); }},
      {"show_session { session_id: \"s6\" }", "session_record { session_id: \"s6\" }",
       [](Client& dts) { return text_of(dts.show_session("s6")); }},
      {"list_protocols { }", "protocols { protocols { name: \"free\" } }", [](Client& dts) { return text_of(dts.list_protocols()); }},
      {"trial { rig: \"chair\" action: TRIAL_ACTION_REDO }", "trial { trial: 2 }",
       [](Client& dts) { return text_of(dts.trial(v1::TRIAL_ACTION_REDO, "chair")); }},
      {"get_audit { limit: 20 }", "audit { verified_entries: 9 }", [](Client& dts) { return text_of(dts.audit(20)); }},
      {"list_keys { }", "keys { server_public_key: \"x\" }", [](Client& dts) { return text_of(dts.list_keys()); }},
      {"add_key { name: \"a\" role: ROLE_VIEWER }", "keys { keys { name: \"a\" } }",
       [](Client& dts) { return text_of(dts.add_key(from_text<v1::AddKeyRequest>("name: 'a' role: ROLE_VIEWER"))); }},
      {"revoke_key { name: \"a\" }", "keys { control_endpoint: \"y\" }", [](Client& dts) { return text_of(dts.revoke_key("a")); }},
      {"correct_session { session_id: \"s7\" label: \"\" reason: \"r\" }", "session_record { session_id: \"s7\" }",
       [](Client& dts) {
         return text_of(dts.correct_session(from_text<v1::CorrectSessionRequest>("session_id: 's7' label: '' reason: 'r'")));
       }},
      {"delete_session { session_id: \"s8\" is_restore: true }", "session_record { session_id: \"s8\" }",
       [](Client& dts) { return text_of(dts.delete_session(from_text<v1::DeleteSessionRequest>("session_id: 's8' is_restore: true"))); }},
      {"list_subjects { }", "subjects { subjects { subject: \"P017\" } }", [](Client& dts) { return text_of(dts.list_subjects()); }},
      {"show_subject { subject: \"P017\" }", "subject { about { subject: \"P017\" } }",
       [](Client& dts) { return text_of(dts.show_subject("P017")); }},
      {"erase_subject { subject: \"P017\" }", "erased { sessions: 2 }", [](Client& dts) { return text_of(dts.erase_subject("P017")); }},
      {"note_login { user: \"a\" }", "note_login { }", {}}};
}

TEST_F(ControlClientTest, EveryCommand_CarriesItsArgumentsAndReturnsItsAnswer) {
  std::mutex mutex;
  std::string asked;
  std::string answer;
  const FakeController daemon(endpoint_, [&](const v1::Request& request, int) {
    const std::lock_guard lock(mutex);
    v1::Request without_id = request;
    without_id.clear_request_id();
    asked = text_of(std::move(without_id));
    auto response = testing::from_text<v1::Response>(answer);
    response.set_request_id(request.request_id());
    return std::vector{response.SerializeAsString()};
  });
  ControlClient dts = client();
  const auto play = [&](const std::string& given) {
    const std::lock_guard lock(mutex);
    asked.clear();
    answer = given;
  };

  for (const Command& command : commands()) {
    SCOPED_TRACE(command.request);
    const std::string other = command.request.starts_with("status") ? "mark { }" : "status { instance_id: 7 }";
    const std::string wrong = "the answer of the daemon does not match the command";
    play(command.answer);
    if (command.call) {
      EXPECT_EQ(command.answer, command.answer.substr(0, command.answer.find('{') + 2) + command.call(dts) + "}");
      EXPECT_EQ(asked, command.request + " ");
      play(other);
      EXPECT_EQ(command.call(dts), wrong);
      play(command.answer);
    }
    auto passed_on = dts.forward(testing::from_text<v1::Request>(command.request));
    ASSERT_TRUE(passed_on) << passed_on.error().what;
    passed_on->clear_request_id();
    EXPECT_EQ(text_of(std::move(*passed_on)), command.answer + " ");
    EXPECT_EQ(asked, command.request + " ");
    play(other);
    EXPECT_EQ(text_of(dts.forward(testing::from_text<v1::Request>(command.request))), wrong);
  }
  play("session { }");
  const std::string senseless = "invalid answer of the daemon: a session has no ID";
  EXPECT_EQ(text_of(dts.stop_session("floor")), senseless);
  EXPECT_EQ(text_of(dts.forward(testing::from_text<v1::Request>("stop_session { }"))), senseless);
  EXPECT_EQ(text_of(dts.forward({})), "the request has no command that this version knows");
}

TEST_F(ControlClientTest, CommandThatIsTooLong_InvalidArgumentAndNothingIsSent) {
  const FakeController daemon(endpoint_, answer_status);

  const auto mark = client().mark(std::string(10'000, 'x'), "floor");
  ASSERT_FALSE(mark);
  EXPECT_EQ(mark.error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(mark.error().hint, "shorten its texts");
}

TEST_F(ControlClientTest, TextThatIsNotUtf8_InvalidArgumentAndNothingIsSent) {
  const FakeController daemon(endpoint_, answer_status);

  const auto mark = client().mark("caf\xe9", "floor");

  ASSERT_FALSE(mark.has_value());
  EXPECT_EQ(mark.error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(daemon.requests(), 0);
}

TEST_F(ControlClientTest, ReplyAfterRestartOfTheDaemon_Arrives) {
  ControlClient dts = client();
  {
    const FakeController daemon(endpoint_, answer_status);
    ASSERT_TRUE(dts.status().has_value());
  }
  const FakeController daemon(endpoint_, answer_status);

  EXPECT_TRUE(dts.status().has_value());
}

TEST_F(ControlClientTest, Call_TakesAnyCommandWithItsAnswer) {
  const FakeController daemon(endpoint_, answer_status);
  ControlClient dts = client();

  EXPECT_EQ(dts.call<v1::StatusSnapshot>(v1::StatusRequest())->instance_id(), testing::floor_status().instance_id());
  EXPECT_EQ(dts.call<v1::TareResponse>(v1::StatusRequest()).error().what,
            "dts.v1.StatusRequest is not a command with the answer dts.v1.TareResponse");
  EXPECT_EQ(dts.call<v1::TareResponse>(v1::TareResponse()).error().code, ErrorCode::InvalidArgument);
}

TEST(ControlOptions, AtTheirLimits_AreAcceptedAndNotBeyond) {
  using std::chrono::milliseconds;
  const milliseconds longest = std::chrono::hours(24);
  const std::string time_out = "the timeout must be from 0.03 s to 86400 s";
  const std::vector<std::pair<ControlOptions, std::string>> rows{{{.endpoint = ""}, "the control address of the daemon is not known"},
                                                                 {{.timeout = milliseconds(30), .tries = 1}, ""},
                                                                 {{.timeout = longest, .tries = 10}, ""},
                                                                 {{.timeout = milliseconds(29)}, time_out},
                                                                 {{.timeout = longest + milliseconds(1)}, time_out},
                                                                 {{.tries = 0}, "tries must be from 1 to 10"},
                                                                 {{.tries = 11}, "tries must be from 1 to 10"}};
  for (auto [options, what] : rows) {
    if (what.find("address") == std::string::npos) options.endpoint = "ipc:///x";
    const auto opened = ControlClient::open(options);
    EXPECT_EQ(opened ? "" : opened.error().what, what);
    EXPECT_TRUE(opened || opened.error().code == ErrorCode::InvalidArgument);
  }
}

TEST(ControlClient, AddressThatNoTransportKnows_InvalidArgument) {
  auto dts = ControlClient::open({.endpoint = "carrier-pigeon://x"});
  ASSERT_TRUE(dts.has_value());

  const auto status = dts->status();

  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code, ErrorCode::InvalidArgument);
}

}  // namespace
}  // namespace dts::client
