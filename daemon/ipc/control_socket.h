// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <zmq.hpp>

#include "core/result.h"
#include "ipc/remote_endpoint.h"

namespace dts::ipc {

/// A message to the daemon: [identity] [empty, from REQ clients] [payload], and who sent it.
struct Incoming {
  std::vector<std::string> envelope;  ///< What goes back in front of the answer.
  std::string payload;
  std::optional<std::string> public_key{};  ///< Of a client with a key; nothing: it came over a local socket.
  bool is_well_formed = false;  ///< False: it had other frames than these; there is no payload.
};

/// A ROUTER socket for commands, of this machine or of others: one socket for each, so that who somebody is never depends on what he
/// says (over a local socket anybody could send a "User-Id"). Thread: control.
class ControlSocket {
 public:
  /// Binds. Fails with the endpoint and the reason.
  [[nodiscard]] static core::Result<ControlSocket> bind(zmq::context_t& context, const std::string& endpoint);
  [[nodiscard]] static core::Result<ControlSocket> bind(zmq::context_t& context, const RemoteEndpoint& remote);

  [[nodiscard]] std::optional<Incoming> receive();
  /// Never waits: a client that left or does not read asks again if it still wants to know.
  void reply(const std::vector<std::string>& envelope, const std::string& bytes) noexcept;
  /// Ends all connections of a remote socket; false: try again later. A local one keeps its own.
  [[nodiscard]] bool drop_peers() noexcept { return !is_remote() || drop_connections(socket_, bound_); }
  [[nodiscard]] bool is_remote() const noexcept { return !bound_.empty(); }
  [[nodiscard]] void* handle() noexcept { return socket_.handle(); }

 private:
  ControlSocket(zmq::socket_t socket, std::string bound) : socket_(std::move(socket)), bound_(std::move(bound)) {}

  zmq::socket_t socket_;
  std::string bound_;  ///< The remote address; empty: a local socket.
};

}  // namespace dts::ipc
