// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>
#include <zmq.hpp>

#include "core/clock.h"
#include "relay/authenticator.h"
#include "unit/access/key_fixture.h"

namespace dts::relay {

using Frames = std::vector<std::string>;

inline bool eventually(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (std::chrono::steady_clock::now() < deadline) {
    if (condition()) return true;
  }
  return condition();
}

inline void send(zmq::socket_t& socket, const Frames& frames) {
  for (const std::string& frame : frames)
    socket.send(zmq::buffer(frame),
                zmq::send_flags::dontwait | (&frame == &frames.back() ? zmq::send_flags::none : zmq::send_flags::sndmore));
}

/// Returns the next message, or nothing if none has arrived.
inline Frames receive_now(zmq::socket_t& socket) {
  Frames frames;
  zmq::message_t frame;
  do {
    if (!socket.recv(frame, zmq::recv_flags::dontwait)) return {};
    frames.push_back(frame.to_string());
  } while (frame.more());
  return frames;
}

/// Keys of two clients, an authenticator, and a port.
class RelayFixture : public access::KeyFixture {
 protected:
  RelayFixture() {
    EXPECT_TRUE(store_->add(access::key_for("eve", v1::ROLE_VIEWER, eve_)));
    EXPECT_TRUE(store_->add(access::key_for("ina", v1::ROLE_ENGINEER, ina_)));
    keys_ = FreshKeys::open(directory(), core::Log()).value();
    authenticator_ = Authenticator::start(context_, *keys_, clock_).value();
  }
  /// Binds a part of the relay to some free port, which is `remote_` then.
  template <class Bind>
  auto bound(Bind bind) {
    for (int port = 20'000 + static_cast<int>(::getpid() % 10'000);; ++port) {
      remote_ = "tcp://127.0.0.1:" + std::to_string(port);
      if (auto part = bind(RemoteEndpoint{remote_, store_->server()})) return std::move(*part);
    }
  }
  zmq::socket_t client(zmq::socket_type type, const access::KeyPair& key) {
    zmq::socket_t socket(clients_, type);
    socket.set(zmq::sockopt::linger, 0);
    socket.set(zmq::sockopt::curve_serverkey, store_->server().public_key);
    socket.set(zmq::sockopt::curve_publickey, key.public_key);
    socket.set(zmq::sockopt::curve_secretkey, key.secret_key);
    socket.connect(remote_);
    return socket;
  }
  [[nodiscard]] std::string local() const { return "ipc://" + folder_ + "/s"; }

  const access::KeyPair eve_ = access::new_pair();
  const access::KeyPair ina_ = access::new_pair();
  core::VirtualClock clock_;
  zmq::context_t context_{1};
  zmq::context_t clients_{1};
  std::unique_ptr<FreshKeys> keys_;
  std::unique_ptr<Authenticator> authenticator_;
  std::string remote_;
};

}  // namespace dts::relay
