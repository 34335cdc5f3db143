// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <zmq.hpp>

#include "access/key_files.h"
#include "core/result.h"

namespace dts::relay {

/// An address for other machines, and the key pair that identifies this site to them. Clients without their own key cannot connect.
struct RemoteEndpoint {
  std::string endpoint;
  access::ServerKey key;
};

/// A socket that other machines reach. All their connections can be ended at once: libzmq cannot end a single one. Thread: one.
class RemoteListener {
 public:
  /// Binds `socket`, whose other options are set. `what`: "control" or "data", for the message. Fails with the address and the reason.
  [[nodiscard]] static core::Result<RemoteListener> bind(zmq::socket_t socket, const RemoteEndpoint& remote, const std::string& what);

  [[nodiscard]] zmq::socket_t& socket() noexcept { return socket_; }
  /// Ends every connection and listens again. Clients that are still authorised reconnect within 100 ms by themselves. Returns false if the
  /// address could not be bound again: then nothing listens there; try again later.
  [[nodiscard]] bool drop_connections() noexcept;

 private:
  RemoteListener(zmq::socket_t socket, std::string bound) : socket_(std::move(socket)), bound_(std::move(bound)) {}

  zmq::socket_t socket_;
  std::string bound_;  ///< The address as libzmq names it.
};

}  // namespace dts::relay
