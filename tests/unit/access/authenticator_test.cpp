// SPDX-License-Identifier: Apache-2.0
#include "access/authenticator.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <thread>

#include "core/clock.h"
#include "key_fixture.h"

namespace dts::access {
namespace {

constexpr int kPatienceMs = 60'000;
constexpr int kRefusedMs = 500;  // a message that is let through in spite of a refusal comes within this
constexpr int kHandshakeMs = 300;

/// A real CURVE server, and clients that knock.
class AuthenticatorTest : public KeyFixture {
 protected:
  AuthenticatorTest() {
    auto started = Authenticator::start(context_, *store_, clock_);
    EXPECT_TRUE(started.has_value());
    authenticator_ = std::move(*started);
    server_.set(zmq::sockopt::curve_server, true);
    server_.set(zmq::sockopt::curve_secretkey, store_->server().secret_key);
    server_.set(zmq::sockopt::linger, 0);
    // As the daemon does: of a refusal for now libzmq tells the client nothing, and hangs up when the handshake has taken too long.
    server_.set(zmq::sockopt::handshake_ivl, kHandshakeMs);
    server_.bind("tcp://127.0.0.1:*");
  }

  /// A client that connects and sends a message. One that is refused before it sends has no connection left, for which it would wait for ever.
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

  core::VirtualClock clock_;
  zmq::context_t context_;
  zmq::context_t client_context_;
  std::unique_ptr<Authenticator> authenticator_;
  zmq::socket_t server_{context_, zmq::socket_type::router};
};

TEST_F(AuthenticatorTest, AKnownKey_ComesIn) {
  const KeyPair pair = new_pair();
  ASSERT_TRUE(store_->add(key_for("anna", v1::ROLE_VIEWER, pair)));

  EXPECT_EQ(knock(pair, store_->server().public_key, kPatienceMs), pair.public_key);
  EXPECT_EQ(authenticator_->accepted_total(), 1U);
}

TEST_F(AuthenticatorTest, AStranger_StaysOutside) {
  EXPECT_TRUE(is_kept_out(new_pair()));
  EXPECT_EQ(authenticator_->accepted_total(), 0U);
}

/// What is refused for now comes back by itself: libzmq's client believes a refusal for ever, but not a delay.
TEST_F(AuthenticatorTest, WhoConnectsTooOften_GetsInLater) {
  const KeyPair pair = new_pair();
  ASSERT_TRUE(store_->add(key_for("anna", v1::ROLE_VIEWER, pair)));
  // Time stands still until somebody is refused: however slow the machine is, the limit is reached.
  const std::jthread time([this](const std::stop_token& stop) {
    for (std::uint64_t refused = 0; !stop.stop_requested(); std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
      if (authenticator_->refused_total() == refused) continue;
      refused = authenticator_->refused_total();
      clock_.advance_ns(core::kNanosecondsPerSecond);
    }
  });
  int came = 0;
  for (int turn = 0; turn < 60; ++turn) came += knock(pair, store_->server().public_key, kPatienceMs) ? 1 : 0;

  EXPECT_EQ(came, 60);
  EXPECT_GE(authenticator_->refused_total(), 1U);
}

TEST_F(AuthenticatorTest, ARevokedKey_StaysOutside) {
  const KeyPair pair = new_pair();
  ASSERT_TRUE(store_->add(key_for("anna", v1::ROLE_VIEWER, pair)));
  ASSERT_TRUE(store_->revoke("anna"));

  EXPECT_TRUE(is_kept_out(pair));
}

TEST_F(AuthenticatorTest, AClientOfAnotherDaemon_DoesNotTalkToThisOne) {
  const KeyPair pair = new_pair();
  ASSERT_TRUE(store_->add(key_for("anna", v1::ROLE_VIEWER, pair)));

  EXPECT_FALSE(knock(pair, new_pair().public_key, kRefusedMs));
  EXPECT_EQ(authenticator_->accepted_total(), 0U);
}

}  // namespace
}  // namespace dts::access
