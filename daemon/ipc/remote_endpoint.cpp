// SPDX-License-Identifier: Apache-2.0
#include "ipc/remote_endpoint.h"

namespace dts::ipc {
namespace {

// Masks of the context's network threads: the first, the second.
constexpr std::uint64_t kLocalThread = 1;
constexpr std::uint64_t kRemoteThread = 2;

constexpr int kQuietS = 2;  // after this silence, the kernel probes the peer every second
constexpr int kGoneMs = 5000;

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
/// reads a ping of that peer's heartbeats. ControlServer::receive keeps the queue of commands short; it grows only while the control thread
/// waits for the disk.
void never_stop_reading(zmq::socket_t& socket) { socket.set(zmq::sockopt::rcvhwm, 0); }

}  // namespace

void use_local_thread(zmq::socket_t& socket) { socket.set(zmq::sockopt::affinity, kLocalThread); }

std::string bind_remote(zmq::socket_t& socket, const RemoteEndpoint& remote) {
  socket.set(zmq::sockopt::affinity, kRemoteThread);
  socket.set(zmq::sockopt::curve_server, true);
  socket.set(zmq::sockopt::curve_secretkey, remote.key.secret_key);
  watch_for_dead_peers(socket);
  never_stop_reading(socket);
  socket.bind(remote.endpoint);
  return socket.get(zmq::sockopt::last_endpoint);
}

bool drop_connections(zmq::socket_t& socket, const std::string& bound) noexcept {
  // Ignores a failure: an earlier attempt may have unbound the socket.
  static_cast<void>(zmq_unbind(socket.handle(), bound.c_str()));
  return zmq_bind(socket.handle(), bound.c_str()) == 0;
}

}  // namespace dts::ipc
