// SPDX-License-Identifier: Apache-2.0
// What the daemon gets of a browser's command.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>
#include <zmq.hpp>

#include "gateway/access/command_id.h"
#include "gateway/bus/hub.h"
#include "unit/gateway/answered_test.h"
#include "unit/gateway/bus/fake_connection.h"

namespace dts::gateway {
namespace {

v1::FromBrowser start_of(const std::string& request_id) {
  v1::FromBrowser message;
  v1::Request& request = *message.mutable_request();
  request.set_request_id(request_id);
  request.mutable_start_session()->set_rig("floor");
  auto& fields = *request.mutable_start_session()->mutable_fields();
  for (char field = 'a'; field <= 'z'; ++field) fields[std::string(1, field)] = "x";
  return message;
}

class ForwardedCommandTest : public IoTest {
 protected:
  ForwardedCommandTest() {
    daemon_.set(zmq::sockopt::linger, 0);
    daemon_.set(zmq::sockopt::rcvtimeo, static_cast<int>(testing::kDeadline.count()));
    daemon_.bind(endpoint_);
  }
  std::unique_ptr<Tab> open(const std::string& user) { return hub_.open_tab({.user = user, .role = v1::ROLE_OPERATOR}, connection_); }

  /// Says it in a tab and answers for the daemon; the bytes that the daemon got.
  std::string sent_by(Tab& tab, const v1::FromBrowser& message) {
    zmq::message_t frame;
    while (daemon_.recv(frame, zmq::recv_flags::dontwait)) {  // asked again on a machine so slow that our answer came late
    }
    say(tab, message);
    std::vector<std::string> frames;
    do {
      if (!daemon_.recv(frame)) return {};
      frames.push_back(frame.to_string());
    } while (frame.more());
    v1::Request request;
    EXPECT_TRUE(request.ParseFromString(frames.back()));
    daemon_.send(zmq::buffer(frames.front()), zmq::send_flags::sndmore);
    daemon_.send(zmq::message_t(), zmq::send_flags::sndmore);
    daemon_.send(zmq::buffer(testing::reply(request, [](v1::Response& response) { response.mutable_session()->set_session_id("s1"); })),
                 zmq::send_flags::none);
    const std::size_t before = connection_.sent.size();
    EXPECT_TRUE(runs_until([&] { return connection_.sent.size() > before; }));
    return frames.back();
  }
  v1::Request request_of(Tab& tab, const v1::FromBrowser& message) {
    v1::Request request;
    EXPECT_TRUE(request.ParseFromString(sent_by(tab, message)));
    return request;
  }

  testing::TemporaryDirectory directory_;
  std::string endpoint_ = directory_.endpoint("control.sock");
  zmq::context_t context_{1};
  zmq::socket_t daemon_{context_, zmq::socket_type::router};
  FakeConnection connection_;
  CommandPool commands_{io_, endpoint_};
  Hub hub_{io_, &commands_, [](const std::vector<std::string>&) {}, "1.2.3"};
};

TEST_F(ForwardedCommandTest, ARepeatIsTheSameToTheLastByteAlsoOverAnotherConnection) {
  const auto tab = open("anna");
  const std::string first = sent_by(*tab, start_of("r1"));
  const auto reopened = open("anna");

  EXPECT_FALSE(first.empty());
  EXPECT_EQ(sent_by(*tab, start_of("r1")), first);
  EXPECT_EQ(sent_by(*reopened, start_of("r1")), first);
}

TEST_F(ForwardedCommandTest, EqualIdsOfTwoUsersAreTwoCommandsAndEachAnswerHasTheBrowsersId) {
  const auto anna = open("anna");
  const auto bert = open("bert");
  const std::string id_of_anna = request_of(*anna, start_of("r1")).request_id();
  const std::string id_of_bert = request_of(*bert, start_of("r1")).request_id();

  EXPECT_NE(id_of_anna, id_of_bert);
  EXPECT_NE(request_of(*anna, start_of("r2")).request_id(), id_of_anna);
  std::vector<std::string> answered;
  for (const v1::FromGateway& message : connection_.sent) {
    if (message.has_response()) answered.push_back(message.response().request_id());
  }
  EXPECT_EQ(answered, (std::vector<std::string>{"r1", "r1", "r2"}));
}

TEST_F(ForwardedCommandTest, WhoIsLoggedInIsNamedAndNobodyElseWhateverTheBrowserSays) {
  v1::FromBrowser disguised = start_of("r1");
  disguised.mutable_request()->set_on_behalf_of("otto");

  EXPECT_EQ(request_of(*open("anna"), disguised).on_behalf_of(), "anna");
  EXPECT_EQ(request_of(*open("local"), disguised).on_behalf_of(), "") << "the audit trail would say local:local, or worse";
}

TEST(CommandId, IsFitForTheDaemonAndTellsWhereTheNameEnds) {
  EXPECT_EQ(command_id("anna", std::string(64, 'x')).size(), 64U);
  EXPECT_NE(command_id("anna", "b"), command_id("ann", "ab"));
  EXPECT_EQ(command_id("anna", "b"), command_id("anna", "b"));
}

}  // namespace
}  // namespace dts::gateway
