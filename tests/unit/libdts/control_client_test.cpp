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
}

TEST_F(ControlClientTest, FirstReplyLost_SameRequestIsSentAgainAndExecutedOnce) {
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

    const auto session = client(std::chrono::milliseconds(5000), 10).start_session(request);

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
    if (status.error().what.find("no proper answer") != std::string::npos) break;
    status = client(timeout).status();
  }

  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code, ErrorCode::Unreachable);
  EXPECT_NE(status.error().what.find("no proper answer"), std::string::npos);
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

TEST_F(ControlClientTest, AnswerOfAnotherCommand_DataDamaged) {
  const FakeController daemon(endpoint_, answer_status);

  const auto rigs = client().list_rigs();

  ASSERT_FALSE(rigs.has_value());
  EXPECT_EQ(rigs.error().code, ErrorCode::DataDamaged);
}

TEST_F(ControlClientTest, AnswerWithImpossibleRate_DataDamagedSaysWhere) {
  const FakeController daemon(endpoint_, [](const v1::Request& request, int) {
    return std::vector{reply(request, [](v1::Response& response) {
      *response.mutable_status() = testing::floor_status();
      response.mutable_status()->mutable_rigs(0)->mutable_rig()->mutable_streams(0)->mutable_rate()->set_denominator(0);
    })};
  });

  const auto status = client().status();

  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().code, ErrorCode::DataDamaged);
  EXPECT_NE(status.error().what.find("cop"), std::string::npos);
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

  EXPECT_EQ(dts.stop_session("floor").error(), (Error{ErrorCode::Failed, "the daemon refused and gave no reason", std::string(2000, 'y')}));
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

TEST_F(ControlClientTest, EveryCommand_CarriesItsArguments) {
  const FakeController daemon(endpoint_, [](const v1::Request& request, int) {
    return std::vector{reply(request, [&request](v1::Response& response) {
      switch (request.command_case()) {
        case v1::Request::kMark: response.mutable_mark()->add_marks()->set_rig(request.mark().text() + "@" + request.mark().rig()); break;
        case v1::Request::kTare: response.mutable_tare()->add_baseline_mm(request.tare().rig() == "floor" ? 9.5 : 0.0); break;
        case v1::Request::kGetDevices: response.mutable_devices()->add_kinds("sim:floor"); break;
        case v1::Request::kTestDevice: response.mutable_device_test()->add_channels()->set_name(request.test_device().rig()); break;
        case v1::Request::kListRigs: response.mutable_rigs()->add_rigs()->set_name("floor"); break;
        case v1::Request::kStopSession:
          response.mutable_session()->set_session_id(request.stop_session().rig() + request.stop_session().reason());
          break;
        case v1::Request::kResumeSession: response.mutable_session()->set_session_id(request.resume_session().session_id()); break;
        case v1::Request::kTrial:
          response.mutable_trial()->set_trial(static_cast<std::uint32_t>(request.trial().action()));
          response.mutable_trial()->set_condition(request.trial().rig());
          break;
        case v1::Request::kListSessions:
          response.mutable_sessions()->add_sessions()->set_session_id(request.list_sessions().subject());
          break;
        case v1::Request::kShowSession: response.mutable_session_record()->set_session_id(request.show_session().session_id()); break;
        case v1::Request::kListProtocols: response.mutable_protocols()->add_protocols()->set_name("free"); break;
        case v1::Request::kGetAudit: response.mutable_audit()->set_verified_entries(request.get_audit().limit()); break;
        default: break;
      }
    })};
  });
  ControlClient dts = client();

  EXPECT_EQ(dts.mark("hello", "floor")->marks(0).rig(), "hello@floor");
  EXPECT_EQ(dts.tare("floor")->baseline_mm(0), 9.5);
  EXPECT_EQ(dts.devices()->kinds(0), "sim:floor");
  EXPECT_EQ(dts.test_device("chair")->channels(0).name(), "chair");
  EXPECT_EQ(dts.list_rigs()->rigs(0).name(), "floor");
  EXPECT_EQ(dts.stop_session("floor")->session_id(), "floor");
  v1::StopSessionRequest abort;
  abort.set_rig("floor");
  abort.set_reason(" dizzy");
  EXPECT_EQ(dts.stop_session(abort)->session_id(), "floor dizzy");
  EXPECT_EQ(dts.resume_session("s1")->session_id(), "s1");
  EXPECT_EQ(dts.trial(v1::TRIAL_ACTION_REDO, "chair")->trial(), 2U);
  EXPECT_EQ(dts.trial(v1::TRIAL_ACTION_REDO, "chair")->condition(), "chair");
  v1::ListSessionsRequest list;
  list.set_subject("P017");
  EXPECT_EQ(dts.list_sessions(list)->sessions(0).session_id(), "P017");
  EXPECT_EQ(dts.show_session("s1")->session_id(), "s1");
  EXPECT_EQ(dts.list_protocols()->protocols(0).name(), "free");
  EXPECT_EQ(dts.audit(20)->verified_entries(), 20U);
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
            "dts.v1.StatusRequest is no command that dts.v1.TareResponse answers");
  EXPECT_EQ(dts.call<v1::TareResponse>(v1::TareResponse()).error().code, ErrorCode::InvalidArgument);
}

TEST(ControlOptions, OutOfRange_AreRefused) {
  EXPECT_FALSE(ControlClient::open({.endpoint = ""}).has_value());
  EXPECT_FALSE(ControlClient::open({.endpoint = "ipc:///x", .timeout = std::chrono::milliseconds(0)}).has_value());
  EXPECT_FALSE(ControlClient::open({.endpoint = "ipc:///x", .timeout = std::chrono::hours(25)}).has_value());
  EXPECT_FALSE(ControlClient::open({.endpoint = "ipc:///x", .timeout = std::chrono::milliseconds(29)}).has_value());
  EXPECT_FALSE(ControlClient::open({.endpoint = "ipc:///x", .tries = 0}).has_value());
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
