// SPDX-License-Identifier: Apache-2.0
#include "relay/authenticator.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "core/clock.h"
#include "unit/access/key_fixture.h"

namespace dts::relay {
namespace {

using access::bytes_of;
using access::key_for;
using access::KeyPair;
using access::new_pair;

constexpr int kPatienceMs = 60'000;
constexpr int kRefusedMs = 500;  // a message that is let through in spite of a refusal comes within this
constexpr int kHandshakeMs = 300;

/// A real CURVE server, and clients that knock.
class AuthenticatorTest : public access::KeyFixture {
 protected:
  AuthenticatorTest() {
    keys_ = FreshKeys::open(directory(), core::Log()).value();
    auto started = Authenticator::start(context_, *keys_, clock_);
    EXPECT_TRUE(started.has_value());
    authenticator_ = std::move(*started);
    server_.set(zmq::sockopt::curve_server, true);
    server_.set(zmq::sockopt::curve_secretkey, store_->server().secret_key);
    server_.set(zmq::sockopt::linger, 0);
    // As the daemon does: of a refusal for now libzmq tells the client nothing, and hangs up when the handshake has taken too long.
    server_.set(zmq::sockopt::handshake_ivl, kHandshakeMs);
    server_.bind("tcp://127.0.0.1:*");
  }

  /// A client that connects and sends a message. One that is refused before it sends has no connection left, for which it would wait for
  /// ever.
  zmq::socket_t client_of(const KeyPair& pair, const std::string& server_key) {
    zmq::socket_t client(client_context_, zmq::socket_type::dealer);
    client.set(zmq::sockopt::linger, 0);
    client.set(zmq::sockopt::curve_serverkey, server_key);
    client.set(zmq::sockopt::curve_publickey, pair.public_key);
    client.set(zmq::sockopt::curve_secretkey, pair.secret_key);
    client.connect(server_.get(zmq::sockopt::last_endpoint));
    client.send(zmq::str_buffer("hello"), zmq::send_flags::dontwait);
    return client;
  }

  /// "User-Id" of the next message that gets through; nothing when none comes in time.
  std::optional<std::string> received(int patience_ms) {
    server_.set(zmq::sockopt::rcvtimeo, patience_ms);
    zmq::message_t identity;
    zmq::message_t hello;
    if (!server_.recv(identity) || !server_.recv(hello)) return std::nullopt;
    const char* user = zmq_msg_gets(hello.handle(), "User-Id");
    return user == nullptr ? "" : user;
  }
  std::optional<std::string> knock(const KeyPair& pair, const std::string& server_key, int patience_ms) {
    const zmq::socket_t client = client_of(pair, server_key);
    return received(patience_ms);
  }

  /// Returns whether the authenticator refuses this client, and no message of it gets through. Waits until it was refused.
  bool is_kept_out(const KeyPair& pair) {
    const zmq::socket_t client = client_of(pair, store_->server().public_key);
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(kPatienceMs);
    while (authenticator_->refused_total() == 0 && authenticator_->accepted_total() == 0 && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return authenticator_->refused_total() > 0 && !received(kRefusedMs);
  }

  /// Asks as libzmq does; the answer's frames, each behind the one before and a |.
  std::string answer_to(const std::vector<std::string>& question) {
    zmq::socket_t asker(context_, zmq::socket_type::req);
    asker.set(zmq::sockopt::linger, 0);
    asker.set(zmq::sockopt::rcvtimeo, kPatienceMs);
    asker.connect("inproc://zeromq.zap.01");
    for (const std::string& frame : question)
      asker.send(zmq::buffer(frame), &frame == &question.back() ? zmq::send_flags::none : zmq::send_flags::sndmore);
    std::string all;
    zmq::message_t frame;
    do {
      if (!asker.recv(frame)) return "no answer";
      all += (all.empty() ? "" : "|") + frame.to_string();
    } while (frame.more());
    return all;
  }

  core::VirtualClock clock_;
  zmq::context_t context_;
  zmq::context_t client_context_;
  std::unique_ptr<FreshKeys> keys_;  ///< Of the same files as the store.
  std::unique_ptr<Authenticator> authenticator_;
  zmq::socket_t server_{context_, zmq::socket_type::router};
};

TEST_F(AuthenticatorTest, AKnownKey_ComesIn) {
  const KeyPair pair = new_pair();
  ASSERT_TRUE(store_->add(key_for("anna", v1::ROLE_VIEWER, pair)));

  EXPECT_EQ(knock(pair, store_->server().public_key, kPatienceMs), pair.public_key);
  EXPECT_EQ(authenticator_->accepted_total(), 1U);
}

/// Every question of libzmq, and what it is answered (ZeroMQ RFC 27).
TEST_F(AuthenticatorTest, Questions_AndTheirAnswers) {
  const KeyPair pair = new_pair();
  ASSERT_TRUE(store_->add(key_for("anna", v1::ROLE_VIEWER, pair)));
  const auto bytes = bytes_of(pair.public_key);
  const std::string key(bytes.begin(), bytes.end());
  const std::string welcome = "1.0|id|200|OK|" + pair.public_key + "|";
  const std::string stranger = "1.0|id|400|no such key||";
  const struct {
    std::vector<std::string> question;
    std::string answer;
  } rows[]{
      {{"1.0", "id", "", "127.0.0.1", "", "CURVE", key}, welcome},
      {{"1.1", "id", "", "127.0.0.1", "", "CURVE", key}, stranger},
      {{"1.0", "id", "", "127.0.0.1", "", "PLAIN", key}, stranger},
      {{"1.0", "id", "", "127.0.0.1", "", "CURVE", std::string(32, 'x')}, stranger},
      {{"1.0", "id", "", "127.0.0.1", "", "CURVE", key + "x"}, stranger},
      {{"1.0", "id", "", "127.0.0.1", "", "CURVE"}, stranger},
      {{"1.0", "id", "", "127.0.0.1", "", "CURVE", key, ""}, stranger},
      {{"1.0", "id"}, stranger},
      {{"1.0"}, "1.0||400|no such key||"},
  };
  for (const auto& row : rows) EXPECT_EQ(answer_to(row.question), row.answer);
  EXPECT_EQ(authenticator_->accepted_total(), 1U);
  EXPECT_EQ(authenticator_->refused_total(), 8U);

  const auto accepted = [&] {
    int count = 0;
    while (answer_to(rows[0].question) == welcome) ++count;
    return count;
  };
  EXPECT_EQ(accepted(), 49) << "50 at once";
  EXPECT_EQ(answer_to(rows[0].question), "1.0|id|300|too many attempts, try again later||");
  clock_.advance_ns(core::kNanosecondsPerSecond);
  EXPECT_EQ(accepted(), 5) << "and 5 a second";
}

/// What is refused for now comes back by itself: libzmq's client believes a refusal for ever, but not a delay.
TEST_F(AuthenticatorTest, WhoConnectsTooOften_GetsInLater) {
  const KeyPair pair = new_pair();
  ASSERT_TRUE(store_->add(key_for("anna", v1::ROLE_VIEWER, pair)));
  const auto bytes = bytes_of(pair.public_key);
  const std::vector<std::string> question{"1.0", "id", "", "", "", "CURVE", std::string(bytes.begin(), bytes.end())};
  for (int turn = 0; turn < 50; ++turn) static_cast<void>(answer_to(question));
  const zmq::socket_t client = client_of(pair, store_->server().public_key);
  while (authenticator_->refused_total() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  clock_.advance_ns(core::kNanosecondsPerSecond);

  EXPECT_EQ(received(kPatienceMs), pair.public_key);
}

TEST_F(AuthenticatorTest, ARevokedKey_StaysOutside) {
  const KeyPair pair = new_pair();
  ASSERT_TRUE(store_->add(key_for("anna", v1::ROLE_VIEWER, pair)));
  ASSERT_TRUE(store_->revoke("anna"));

  EXPECT_TRUE(is_kept_out(pair));
  EXPECT_EQ(authenticator_->accepted_total(), 0U);
}

}  // namespace
}  // namespace dts::relay
