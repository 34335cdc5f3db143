// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <zmq.hpp>

#include "core/result.h"
#include "ipc/remote_endpoint.h"

namespace dts::ipc {

/// A message to the daemon, [identity] [empty, from REQ clients] [payload], and its sender.
struct Incoming {
  std::vector<std::string> envelope;  ///< The frames to send before the answer.
  std::string payload;
  std::optional<std::string> public_key{};  ///< Public key of a remote client; absent: from a local socket.
  bool is_well_formed = false;              ///< False: the message had other frames; `payload` is empty.
};

/// A ROUTER socket for commands, either from this machine or from others. Local and remote clients have separate sockets, so that the
/// identity of a sender never depends on its message (a local client could send any "User-Id"). Thread: control.
class ControlSocket {
 public:
  /// Binds a socket. Fails with the endpoint and the reason.
  [[nodiscard]] static core::Result<ControlSocket> bind(zmq::context_t& context, const std::string& endpoint);
  [[nodiscard]] static core::Result<ControlSocket> bind(zmq::context_t& context, const RemoteEndpoint& remote);

  [[nodiscard]] std::optional<Incoming> receive();
  /// Sends an answer without waiting. Drops it if the client has left or does not read; the client can repeat its request.
  void reply(const std::vector<std::string>& envelope, const std::string& bytes) noexcept;
  /// Ends all connections of a remote socket; does nothing for a local one. Returns false if it failed: try again later.
  [[nodiscard]] bool drop_peers() noexcept { return !is_remote() || drop_connections(socket_, bound_); }
  [[nodiscard]] bool is_remote() const noexcept { return !bound_.empty(); }
  [[nodiscard]] void* handle() noexcept { return socket_.handle(); }

 private:
  ControlSocket(zmq::socket_t socket, std::string bound) : socket_(std::move(socket)), bound_(std::move(bound)) {}

  zmq::socket_t socket_;
  std::string bound_;  ///< The remote address; empty: a local socket.
};

}  // namespace dts::ipc
