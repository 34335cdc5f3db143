// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
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

inline constexpr std::size_t kCurveBytes = 33;  // that CURVE adds to a frame; libzmq's limit counts them

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
  zmq::socket_t unconnected_client(zmq::socket_type type, const access::KeyPair& key) {
    zmq::socket_t socket(clients_, type);
    socket.set(zmq::sockopt::linger, 0);
    socket.set(zmq::sockopt::curve_serverkey, store_->server().public_key);
    socket.set(zmq::sockopt::curve_publickey, key.public_key);
    socket.set(zmq::sockopt::curve_secretkey, key.secret_key);
    return socket;
  }
  zmq::socket_t client(zmq::socket_type type, const access::KeyPair& key) {
    zmq::socket_t socket = unconnected_client(type, key);
    socket.connect(remote_);
    return socket;
  }
  /// Returns a socket that gets a message whenever a connection of `socket` has ended.
  zmq::socket_t watch(zmq::socket_t& socket) {
    const std::string address = "inproc://events-of-" + std::to_string(reinterpret_cast<std::uintptr_t>(socket.handle()));
    EXPECT_EQ(zmq_socket_monitor(socket.handle(), address.c_str(), ZMQ_EVENT_DISCONNECTED), 0);
    zmq::socket_t events(clients_, zmq::socket_type::pair);
    events.set(zmq::sockopt::linger, 0);
    events.connect(address);
    return events;
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
