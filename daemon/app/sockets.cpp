// SPDX-License-Identifier: Apache-2.0
#include "app/sockets.h"

#include <optional>
#include <utility>

#include "ipc/local_publisher.h"
#include "ipc/split_socket.h"
#include "ipc/xpub_socket.h"

namespace dts::app {
namespace {

/// Local subscribers connect to a publisher of our own, other machines to libzmq, which has CURVE. A local address that is no Unix socket
/// (tcp://127.0.0.1) is libzmq's too.
core::Result<std::unique_ptr<ipc::DataSocket>> bind_data(zmq::context_t& context, const std::string& endpoint,
                                                         const std::optional<ipc::RemoteEndpoint>& remote, const core::Clock& clock,
                                                         int queue_messages, const core::Log& log) {
  if (!endpoint.starts_with("ipc://")) {
    DTS_TRY_ASSIGN(auto socket, ipc::XpubSocket::bind(context, endpoint, queue_messages, remote));
    return socket;
  }
  DTS_TRY_ASSIGN(auto local, ipc::LocalPublisher::bind(endpoint, clock, log));
  if (!remote) return local;
  DTS_TRY_ASSIGN(auto socket, ipc::XpubSocket::bind(context, "", queue_messages, remote));
  return std::make_unique<ipc::SplitSocket>(std::move(local), std::move(socket));
}

}  // namespace

core::Result<Sockets> Sockets::bind(zmq::context_t& context, const DaemonConfig& config, const access::KeyStore* keys, core::Clock& clock,
                                    int queue_messages, const core::Log& log) {
  Sockets sockets;
  std::optional<ipc::RemoteEndpoint> remote_data;
  if (config.network) {
    DTS_TRY_ASSIGN(sockets.authenticator, access::Authenticator::start(context, *keys, clock));  // before any client can connect
    remote_data = ipc::RemoteEndpoint{config.network->data_endpoint, keys->server()};
  }
  DTS_TRY_ASSIGN(sockets.data, bind_data(context, config.data_endpoint, remote_data, clock, queue_messages, log));
  DTS_TRY_ASSIGN(auto local, ipc::ControlSocket::bind(context, config.control_endpoint));
  sockets.control.push_back(std::move(local));
  if (!config.network) return sockets;
  DTS_TRY_ASSIGN(auto remote, ipc::ControlSocket::bind(context, ipc::RemoteEndpoint{config.network->control_endpoint, keys->server()}));
  sockets.control.push_back(std::move(remote));
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
