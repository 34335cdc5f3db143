// SPDX-License-Identifier: Apache-2.0
// Commands through the relay, with a socket in the place of dtsd.
#include "relay/control_relay.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <sstream>

#include "dts/v1/control.pb.h"
#include "unit/relay/relay_fixture.h"

namespace dts::relay {
namespace {

class ControlRelayTest : public RelayFixture {
 protected:
  void start_daemon() {
    daemon_ = zmq::socket_t(clients_, zmq::socket_type::router);
    daemon_.set(zmq::sockopt::linger, 0);
    daemon_.bind(local());
  }
  /// Serves until the socket has a message.
  Frames next(zmq::socket_t& socket) {
    Frames frames;
    EXPECT_TRUE(eventually([&] {
      relay_.serve(1);
      frames = receive_now(socket);
      return !frames.empty();
    }));
    return frames;
  }
  /// Waits until commands of this client reach dtsd. One is on its way at a time, so that none is left over.
  void connect(zmq::socket_t& by) {
    bool has_arrived = false;
    while (!has_arrived && !HasFailure()) {
      clock_.advance_ns(core::kNanosecondsPerSecond);
      send(by, {"knock"});
      EXPECT_TRUE(eventually([&] {
        relay_.serve(5);
        has_arrived = !receive_now(daemon_).empty();
        return has_arrived || !receive_now(by).empty();  // an answer: dtsd is away
      }));
    }
  }
  static v1::Error error_of(const Frames& answer) {
    v1::Response response;
    EXPECT_TRUE(response.ParseFromString(answer.back()));
    EXPECT_TRUE(response.request_id().empty());
    return response.error();
  }

  std::ostringstream log_;
  ControlRelay relay_ = bound([this](const RemoteEndpoint& remote) {
    const core::Log log(std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(log_)));
    return ControlRelay::open(context_, remote, local(), keys_->store(), clock_, log);
  });
  zmq::socket_t daemon_;
};

TEST_F(ControlRelayTest, CommandArrivesWithItsKey_AndTheAnswerAtItsSender) {
  start_daemon();
  zmq::socket_t eve = client(zmq::socket_type::dealer, eve_);
  zmq::socket_t ina = client(zmq::socket_type::dealer, ina_);
  connect(eve);
  send(eve, {"", "from eve"});
  const Frames first = next(daemon_);
  send(ina, {"from ina"});
  const Frames second = next(daemon_);

  ASSERT_EQ(first.size(), 4U);
  ASSERT_EQ(second.size(), 4U);
  EXPECT_EQ(first[2], eve_.public_key);
  EXPECT_EQ(first[3], "from eve");
  EXPECT_EQ(second[2], ina_.public_key);
  EXPECT_EQ(second[3], "from ina");
  send(daemon_, {second[0], second[1], "to ina"});
  send(daemon_, {first[0], first[1], "to eve"});
  EXPECT_EQ(next(ina), (Frames{"to ina"}));
  EXPECT_EQ(next(eve), (Frames{"", "to eve"})) << "as the sender has framed it";
}

TEST_F(ControlRelayTest, DaemonIsAway_IsSaid_UntilItIsBack) {
  zmq::socket_t eve = client(zmq::socket_type::dealer, eve_);
  send(eve, {"anybody"});
  EXPECT_EQ(error_of(next(eve)).code(), v1::ERROR_CODE_UNREACHABLE);
  start_daemon();
  connect(eve);
  daemon_.close();
  EXPECT_TRUE(eventually([&] {  // what libzmq has sent before it noticed gets no answer
    clock_.advance_ns(core::kNanosecondsPerSecond);
    send(eve, {"anybody"});
    for (int turn = 0; turn < 20; ++turn) {
      relay_.serve(5);
      if (const Frames answer = receive_now(eve); !answer.empty()) return error_of(answer).code() == v1::ERROR_CODE_UNREACHABLE;
    }
    return false;
  }));
}

TEST_F(ControlRelayTest, WhatIsNoRequest_IsAnsweredHere) {
  start_daemon();
  zmq::socket_t eve = client(zmq::socket_type::dealer, eve_);
  connect(eve);
  for (const Frames& frames : {Frames{"x", "request"}, Frames{"", "", "request"}, Frames{"a", "b", "c", "d", "request"}}) {
    send(eve, frames);
    EXPECT_EQ(error_of(next(eve)).what(), "a request must be one frame, or an empty frame and then one frame");
  }
  EXPECT_TRUE(receive_now(daemon_).empty());
}

TEST_F(ControlRelayTest, TooManyCommands_AreRefusedAndDoNotReachTheDaemon) {
  start_daemon();
  zmq::socket_t eve = client(zmq::socket_type::dealer, eve_);
  connect(eve);
  clock_.advance_ns(10 * core::kNanosecondsPerSecond);
  int passed = 0;
  Frames refusal;
  for (int number = 0; number < 101; ++number) {
    send(eve, {"status"});
    EXPECT_TRUE(eventually([&] {
      relay_.serve(1);
      const bool has_passed = !receive_now(daemon_).empty();
      passed += has_passed ? 1 : 0;
      if (!has_passed) refusal = receive_now(eve);
      return has_passed || !refusal.empty();
    }));
  }

  EXPECT_EQ(passed, 100);
  EXPECT_EQ(error_of(refusal).code(), v1::ERROR_CODE_LIMIT_EXCEEDED);
  EXPECT_EQ(error_of(refusal).what(), "more than 50 commands per second from key:eve");
  const std::string logged = log_.str();
  EXPECT_TRUE(logged.ends_with("rejected 1 malformed or excess requests, the last by key:eve\n")) << logged;
  for (int number = 0; number < 2; ++number) {
    send(eve, {"status"});
    static_cast<void>(next(eve));
  }
  EXPECT_EQ(log_.str(), logged) << "one line a second";
  clock_.advance_ns(core::kNanosecondsPerSecond);
  relay_.serve(0);
  EXPECT_TRUE(log_.str().ends_with("rejected 2 malformed or excess requests, the last by key:eve\n")) << log_.str();
  zmq::socket_t ina = client(zmq::socket_type::dealer, ina_);
  send(ina, {"status"});
  EXPECT_EQ(next(daemon_)[2], ina_.public_key) << "others are not limited by it";
}

TEST_F(ControlRelayTest, LongestRequestPasses_ALongerOneEndsItsConnection) {
  start_daemon();
  zmq::socket_t eve = client(zmq::socket_type::dealer, eve_);
  connect(eve);
  zmq::socket_t ends = watch(eve);
  const std::string longest(4096 - kCurveBytes, 'x');
  send(eve, {longest});
  const Frames passed = next(daemon_);
  ASSERT_EQ(passed.size(), 4U);
  EXPECT_EQ(passed[3], longest);
  EXPECT_TRUE(receive_now(ends).empty());
  send(eve, {longest + "x"});
  EXPECT_FALSE(next(ends).empty());
  connect(eve);
}

/// libzmq's and the kernel's own buffers hold some messages more than the queue.
TEST_F(ControlRelayTest, QueueOfCommands_EndsAt400_WhileTheDaemonDoesNotRead) {
  daemon_ = zmq::socket_t(clients_, zmq::socket_type::router);
  daemon_.set(zmq::sockopt::linger, 0);
  daemon_.set(zmq::sockopt::rcvhwm, 1);
  daemon_.bind(local());
  zmq::socket_t eve = client(zmq::socket_type::dealer, eve_);
  connect(eve);
  int accepted = 0;
  for (bool has_room = true; has_room && accepted < 2000;) {
    clock_.advance_ns(core::kNanosecondsPerSecond);
    for (int number = 0; number < 50; ++number) send(eve, {std::string(4000, 'x')});
    send(eve, {"no", "request"});
    accepted += 50;
    while (error_of(next(eve)).code() == v1::ERROR_CODE_UNREACHABLE) {
      --accepted;
      has_room = false;
    }
  }
  EXPECT_GE(accepted, 395) << "libzmq counts some that have left the queue";
  EXPECT_LT(accepted, 1000);
}

TEST_F(ControlRelayTest, QueueOfAnswers_EndsAt400_WhileAClientDoesNotRead) {
  start_daemon();
  zmq::socket_t ina = client(zmq::socket_type::dealer, ina_);
  connect(ina);
  zmq::socket_t eve = unconnected_client(zmq::socket_type::dealer, eve_);
  eve.set(zmq::sockopt::rcvhwm, 1);
  eve.connect(remote_);
  send(ina, {"1"});
  const Frames of_ina = next(daemon_);
  send(eve, {"1"});
  const Frames of_eve = next(daemon_);
  const std::string answer(std::size_t{32} * 1024, 'x');
  for (int number = 0; number < 800; ++number) {
    send(daemon_, {of_eve[0], of_eve[1], answer});
    if (number % 50 > 0) continue;
    send(daemon_, {of_ina[0], of_ina[1], "passed"});
    EXPECT_EQ(next(ina), Frames{"passed"});
  }
  int accepted = 0;
  EXPECT_TRUE(eventually([&] {
    send(daemon_, {of_eve[0], of_eve[1], "end"});  // is dropped, too, until there is room
    relay_.serve(1);
    while (true) {
      const Frames frames = receive_now(eve);
      if (frames.empty() || frames[0] == "end") return !frames.empty();
      ++accepted;
    }
  }));
  EXPECT_GE(accepted, 395) << "libzmq counts some that have left the queue";
  EXPECT_LT(accepted, 1000);
}

TEST_F(ControlRelayTest, DroppedPeers_ComeBackByThemselves_ExceptARevokedOne) {
  start_daemon();
  zmq::socket_t eve = client(zmq::socket_type::dealer, eve_);
  zmq::socket_t ina = client(zmq::socket_type::dealer, ina_);
  connect(eve);
  connect(ina);
  ASSERT_TRUE(store_->revoke("eve"));
  keys_->look();
  ASSERT_TRUE(keys_->store().take_losses());
  ASSERT_TRUE(relay_.drop_peers());

  const auto sender = [&] {
    relay_.serve(5);
    const Frames frames = receive_now(daemon_);
    return frames.size() == 4 ? frames[2] : "";
  };
  EXPECT_TRUE(eventually([&] {  // what libzmq sends before it notices is lost
    clock_.advance_ns(core::kNanosecondsPerSecond);
    send(ina, {"status"});
    send(eve, {"status"});
    const std::string who = sender();
    EXPECT_NE(who, eve_.public_key);
    return who == ina_.public_key && authenticator_->refused_total() > 0;
  }));
  for (int turn = 0; turn < 20; ++turn) EXPECT_NE(sender(), eve_.public_key);
}

/// A cable that was pulled must not keep a connection: the kernel asks after 2 s, every second, five times.
TEST_F(ControlRelayTest, Connection_IsWatchedByTheKernel) {
  start_daemon();
  zmq::socket_t eve = client(zmq::socket_type::dealer, eve_);
  connect(eve);
  const int port = std::stoi(remote_.substr(remote_.rfind(':') + 1));
  int watched = 0;
  for (int fd = 3; fd < 1000; ++fd) {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    const bool is_ours = ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0 && address.sin_family == AF_INET &&
                         ntohs(address.sin_port) == port;
    if (!is_ours || ::getpeername(fd, reinterpret_cast<sockaddr*>(&address), &size) != 0) continue;
    ++watched;
    const auto option = [fd](int level, int name) {
      int value = 0;
      socklen_t length = sizeof value;
      EXPECT_EQ(::getsockopt(fd, level, name, &value, &length), 0);
      return value;
    };
    EXPECT_NE(option(SOL_SOCKET, SO_KEEPALIVE), 0);
    EXPECT_EQ(option(IPPROTO_TCP, TCP_KEEPIDLE), 2);
    EXPECT_EQ(option(IPPROTO_TCP, TCP_KEEPINTVL), 1);
    EXPECT_EQ(option(IPPROTO_TCP, TCP_KEEPCNT), 5);
    EXPECT_EQ(option(IPPROTO_TCP, TCP_USER_TIMEOUT), 5000);
  }
  EXPECT_EQ(watched, 1);
}

TEST_F(ControlRelayTest, AddressThatThisMachineDoesNotHave_SaysWhatToWrite) {
  const auto opened =
      ControlRelay::open(context_, {"tcp://192.0.2.1:5555", store_->server()}, local(), keys_->store(), clock_, core::Log());

  ASSERT_FALSE(opened);
  EXPECT_NE(opened.error().hint.find("tcp://*:PORT"), std::string::npos) << core::to_string(opened.error());
}

}  // namespace
}  // namespace dts::relay
