// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <zmq.hpp>

#include "core/result.h"

namespace dts::ipc {

/// A message to the daemon, and its sender. Its frames are
///
///     [identity] [payload]                        from a local client
///     [identity] [empty] [payload]                the same, from a REQ socket
///     [identity] [ticket] [public key] [payload]  from dts-relay, for a client on another machine
///
/// dts-relay needs the ticket to find its client again; the daemon only returns it. The public key is a frame of its own, so that no
/// request can contain, hide or replace it.
struct Incoming {
  std::vector<std::string> envelope;  ///< The frames to send before the answer.
  std::string payload;
  std::optional<std::string> public_key{};  ///< Of a client on another machine; absent: a local client.
  bool is_well_formed = false;              ///< False: the message had other frames; `payload` is empty.
};

/// The ROUTER socket for commands. A local client could name a key, as dts-relay does: that can only reduce its rights, because a local
/// client has all. Thread: control.
class ControlSocket {
 public:
  /// Binds a socket. Fails with the endpoint and the reason.
  [[nodiscard]] static core::Result<ControlSocket> bind(zmq::context_t& context, const std::string& endpoint);

  [[nodiscard]] std::optional<Incoming> receive();
  /// Sends an answer without waiting. Drops it if the client has left or does not read; the client can repeat its request.
  void reply(const std::vector<std::string>& envelope, const std::string& bytes) noexcept;
  [[nodiscard]] void* handle() noexcept { return socket_.handle(); }

 private:
  explicit ControlSocket(zmq::socket_t socket) : socket_(std::move(socket)) {}

  zmq::socket_t socket_;
};

}  // namespace dts::ipc
