// SPDX-License-Identifier: Apache-2.0
#include "ipc/remote_endpoint.h"

namespace dts::ipc {
namespace {

// Masks of the context's network threads: the first, the second.
constexpr std::uint64_t kLocalThread = 1;
constexpr std::uint64_t kRemoteThread = 2;

}  // namespace

void use_local_thread(zmq::socket_t& socket) { socket.set(zmq::sockopt::affinity, kLocalThread); }

std::string bind_remote(zmq::socket_t& socket, const RemoteEndpoint& remote) {
  socket.set(zmq::sockopt::affinity, kRemoteThread);
  socket.set(zmq::sockopt::curve_server, true);
  socket.set(zmq::sockopt::curve_secretkey, remote.key.secret_key);
  socket.bind(remote.endpoint);
  return socket.get(zmq::sockopt::last_endpoint);
}

bool drop_connections(zmq::socket_t& socket, const std::string& bound) noexcept {
  // Unbinding fails when an earlier attempt did it already.
  static_cast<void>(zmq_unbind(socket.handle(), bound.c_str()));
  return zmq_bind(socket.handle(), bound.c_str()) == 0;
}

}  // namespace dts::ipc
