// SPDX-License-Identifier: Apache-2.0
#include "app/sockets.h"

#include <optional>
#include <utility>

namespace dts::app {

core::Result<Sockets> Sockets::bind(zmq::context_t& context, const DaemonConfig& config, const access::KeyStore* keys, core::Clock& clock,
                                    int queue_messages) {
  Sockets sockets;
  std::optional<ipc::RemoteEndpoint> remote_data;
  if (config.network) {
    auto authenticator = access::Authenticator::start(context, *keys, clock);  // before any client can connect
    if (!authenticator) return tl::make_unexpected(authenticator.error());
    sockets.authenticator = std::move(*authenticator);
    remote_data = ipc::RemoteEndpoint{config.network->data_endpoint, keys->server()};
  }
  auto data = ipc::XpubSocket::bind(context, config.data_endpoint, queue_messages, remote_data);
  if (!data) return tl::make_unexpected(data.error());
  sockets.data = std::move(*data);
  auto local = ipc::ControlSocket::bind(context, config.control_endpoint);
  if (!local) return tl::make_unexpected(local.error());
  sockets.control.push_back(std::move(*local));
  if (!config.network) return sockets;
  auto remote = ipc::ControlSocket::bind(context, ipc::RemoteEndpoint{config.network->control_endpoint, keys->server()});
  if (!remote) return tl::make_unexpected(remote.error());
  sockets.control.push_back(std::move(*remote));
  return sockets;
}

ipc::RemoteAddresses addresses_of(const DaemonConfig& config) {
  if (!config.network) return {};
  return {.control = config.network->control_endpoint, .data = config.network->data_endpoint};
}

void log_network(const NetworkConfig& network, const access::KeyStore& keys, const core::Log& log) {
  const std::size_t count = keys.keys().size();
  log.info("clients with keys connect to control on " + network.control_endpoint + " and data on " + network.data_endpoint + ": " +
           (count == 0 ? "no client has a key yet, make one: dtsctl key new" : std::to_string(count) + " key(s)"));
}

}  // namespace dts::app
