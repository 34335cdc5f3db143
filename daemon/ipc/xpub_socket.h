// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <zmq.hpp>

#include "core/result.h"
#include "ipc/data_socket.h"
#include "ipc/remote_endpoint.h"

namespace dts::ipc {

/// DataSocket over a libzmq XPUB socket: for other machines, and for a local address that is no Unix socket.
class XpubSocket final : public DataSocket {
 public:
  /// Binds `endpoint` if it is not empty, and `remote` if present. `queue_messages`: size of each subscriber's queue. Fails with the endpoint and the reason.
  [[nodiscard]] static core::Result<std::unique_ptr<XpubSocket>> bind(zmq::context_t& context, const std::string& endpoint,
                                                                      int queue_messages, const std::optional<RemoteEndpoint>& remote = {});

  void send(std::string_view topic, const google::protobuf::MessageLite& message) override;
  void wait(int bell_fd, int timeout_ms) override;
  [[nodiscard]] bool take_subscriptions() override;
  /// Asks libzmq whether a subscriber's message waits, for `take_subscriptions`. Needed before every sleep on `fd`.
  bool look() { return has_input_ = has_input(); }
  /// Becomes readable when libzmq has an event for this socket; libzmq owns it.
  [[nodiscard]] int fd() const noexcept { return socket_fd_; }
  [[nodiscard]] bool drop_remote_peers() noexcept override { return bound_.empty() || drop_connections(socket_, bound_); }

 private:
  XpubSocket(zmq::socket_t socket, std::string bound)
      : socket_(std::move(socket)), bound_(std::move(bound)), socket_fd_(socket_.get(zmq::sockopt::fd)) {}
  [[nodiscard]] bool has_input();

  zmq::socket_t socket_;
  std::string bound_;       ///< The remote address; empty: there is none.
  int socket_fd_;
  bool has_input_ = false;  ///< Result of the last `wait` or `look`.
};

}  // namespace dts::ipc
