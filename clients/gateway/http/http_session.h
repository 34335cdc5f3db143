// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <memory>

#include "gateway/http/server_state.h"

namespace dts::gateway {

/// Serves one accepted connection until it ends or becomes a WebSocket. The session keeps itself alive.
void serve_http(std::shared_ptr<ServerState> server, boost::asio::ip::tcp::socket socket, Peer peer, ConnectionLimits::Seat seat);

}  // namespace dts::gateway
