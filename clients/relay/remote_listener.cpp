// SPDX-License-Identifier: Apache-2.0
#include "relay/remote_listener.h"

#include <cerrno>
#include <chrono>
#include <thread>

namespace dts::relay {
namespace {

constexpr int kQuietS = 2;  // after this silence, the kernel probes the peer every second
constexpr int kGoneMs = 5000;
constexpr int kHandshakeMs = 2000;  // then the connection ends
constexpr int kBindAttempts = 20;
constexpr std::chrono::milliseconds kBindPause{5};

/// Lets the kernel end connections of unplugged peers and of subscribers that read nothing; otherwise they stay open for hours. Does not
/// use libzmq's heartbeats: they abort the process when a peer with a full queue leaves (4.3.5: the timer calls out_event(), which asserts
/// !_io_error).
void watch_for_dead_peers(zmq::socket_t& socket) {
  socket.set(zmq::sockopt::tcp_keepalive, 1);
  socket.set(zmq::sockopt::tcp_keepalive_idle, kQuietS);
  socket.set(zmq::sockopt::tcp_keepalive_intvl, 1);
  socket.set(zmq::sockopt::tcp_keepalive_cnt, kGoneMs / 1000);
  socket.set(zmq::sockopt::tcp_maxrt, kGoneMs);
}

/// Removes the limit of the receive queue. The same assertion aborts the process when a peer with a full queue has left and libzmq then
/// reads a ping of that peer's heartbeats. ControlRelay keeps the queue of commands short.
void never_stop_reading(zmq::socket_t& socket) { socket.set(zmq::sockopt::rcvhwm, 0); }

std::string hint_of(int system_errno) {
  if (system_errno == EADDRNOTAVAIL) {
    return "this machine does not have this address now: write tcp://*:PORT to use all addresses, or correct it in dtsd.toml";
  }
  return system_errno == EADDRINUSE ? "another program listens there: end it, or choose another port in dtsd.toml" : "";
}

}  // namespace

core::Result<RemoteListener> RemoteListener::bind(zmq::socket_t socket, const RemoteEndpoint& remote, const std::string& what) {
  try {
    socket.set(zmq::sockopt::curve_server, true);
    socket.set(zmq::sockopt::curve_secretkey, remote.key.secret_key);
    socket.set(zmq::sockopt::handshake_ivl, kHandshakeMs);
    watch_for_dead_peers(socket);
    never_stop_reading(socket);
    socket.bind(remote.endpoint);
    std::string bound = socket.get(zmq::sockopt::last_endpoint);
    return RemoteListener(std::move(socket), std::move(bound));
  } catch (const zmq::error_t& error) {
    return core::fail_errno(error.num(), what + " socket " + remote.endpoint + " cannot be bound", hint_of(error.num()));
  }
}

bool RemoteListener::drop_connections() noexcept {
  // Ignores a failure: an earlier attempt may have unbound the socket.
  static_cast<void>(zmq_unbind(socket_.handle(), bound_.c_str()));
  // libzmq closes the old listener in its own thread, and the port is not free before.
  for (int attempt = 0; attempt < kBindAttempts; ++attempt) {
    if (zmq_bind(socket_.handle(), bound_.c_str()) == 0) return true;
    std::this_thread::sleep_for(kBindPause);
  }
  return false;
}

}  // namespace dts::relay
