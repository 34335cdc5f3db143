// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ssl/context.hpp>
#include <chrono>
#include <exception>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "gateway/http/connection_limits.h"
#include "gateway/http/host_check.h"
#include "gateway/http/server.h"

namespace dts::gateway {

class Connection;

/// State that the listener and all connections share. Lives as long as the last of them.
struct ServerState {
  ServerState(boost::asio::io_context& context, const ServerOptions& options, ServerHooks its_hooks, bool is_loopback)
      : io(context),
        limits(options.limits),
        hooks(std::move(its_hooks)),
        hosts(options.host_names, is_loopback),
        seats(options.limits.connections) {}

  boost::asio::io_context& io;
  ServerLimits limits;
  ServerHooks hooks;
  HostCheck hosts;
  ConnectionLimits seats;
  std::unique_ptr<boost::asio::ssl::context> tls{};  ///< Null: plain HTTP.
  ServerStatistics statistics{};
  std::set<Connection*> connections{};
};

/// Both ends of a connection, without ports.
struct Peer {
  std::string remote_address;
  std::string local_address;
};

/// A connection as the server sees it, for every protocol.
class Connection {
 public:
  Connection(std::shared_ptr<ServerState> server, Peer peer, ConnectionLimits::Seat seat)
      : server_(std::move(server)), peer_(std::move(peer)), seat_(std::move(seat)) {
    server_->connections.insert(this);
  }
  virtual ~Connection() { server_->connections.erase(this); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// The server stops: ends soon, in an orderly way.
  virtual void go_away() = 0;
  /// The server is gone: ends now, and calls no hooks any more.
  virtual void drop() = 0;

 protected:
  std::shared_ptr<ServerState> server_;
  Peer peer_;
  ConnectionLimits::Seat seat_;
};

/// Calls the rest of the gateway. An exception there is a bug; it ends one connection, not the process. Returns false if the call threw.
template <class Call>
[[nodiscard]] bool returns(Call&& call) noexcept {
  try {
    call();
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace dts::gateway
