// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>
#include <zmq.hpp>

#include "access/authenticator.h"
#include "app/config.h"
#include "ipc/control_socket.h"
#include "ipc/key_commands.h"
#include "ipc/xpub_socket.h"

namespace dts::app {

/// Everything that a daemon listens on: for this machine, and for others if the configuration says so. The authenticator comes first and goes
/// last: without it libzmq lets everybody in.
struct Sockets {
  std::unique_ptr<access::Authenticator> authenticator;  ///< Only with [network]; answers as long as it exists.
  std::unique_ptr<ipc::XpubSocket> data;
  std::vector<ipc::ControlSocket> control;

  /// Binds all or fails with the one that cannot be had. `queue_messages` is kept for each subscriber. `keys` (nullptr without [network]) and `clock` outlive them.
  [[nodiscard]] static core::Result<Sockets> bind(zmq::context_t& context, const DaemonConfig& config, const access::KeyStore* keys,
                                                  core::Clock& clock, int queue_messages);
};

/// Where clients with keys connect; empty without [network].
[[nodiscard]] ipc::RemoteAddresses addresses_of(const DaemonConfig& config);

/// Says where they do, and how many they are.
void log_network(const NetworkConfig& network, const access::KeyStore& keys, const core::Log& log);

}  // namespace dts::app
