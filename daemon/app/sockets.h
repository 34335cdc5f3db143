// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>
#include <zmq.hpp>

#include "access/authenticator.h"
#include "app/config.h"
#include "ipc/control_socket.h"
#include "ipc/key_commands.h"
#include "ipc/data_socket.h"

namespace dts::app {

/// All sockets of the daemon: for this machine, and for others if the configuration has [network]. The authenticator is created first and
/// destroyed last, because libzmq accepts every client without it.
struct Sockets {
  std::unique_ptr<access::Authenticator> authenticator;  ///< Only with [network].
  std::unique_ptr<ipc::DataSocket> data;
  std::vector<ipc::ControlSocket> control;

  /// Binds all sockets, or fails with the one that cannot be bound. `queue_messages`: size of the queue of each subscriber that libzmq serves.
  /// `keys` (nullptr without [network]) and `clock` must outlive the sockets.
  [[nodiscard]] static core::Result<Sockets> bind(zmq::context_t& context, const DaemonConfig& config, const access::KeyStore* keys,
                                                  core::Clock& clock, int queue_messages, const core::Log& log);
};

/// Returns the addresses to which clients with keys connect; empty without [network].
[[nodiscard]] ipc::RemoteAddresses addresses_of(const DaemonConfig& config);

/// Logs these addresses and the number of keys.
void log_network(const NetworkConfig& network, const access::KeyStore& keys, const core::Log& log);

}  // namespace dts::app
