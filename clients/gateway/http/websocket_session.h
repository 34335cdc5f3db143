// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "gateway/http/peer_stream.h"
#include "gateway/http/request_check.h"
#include "gateway/http/server_state.h"

namespace dts::gateway {

/// Answers the upgrade and serves the WebSocket until it ends. The session keeps itself alive.
void serve_websocket(std::shared_ptr<ServerState> server, PeerStream stream, Peer peer, ConnectionLimits::Seat seat, RawRequest upgrade,
                     Query query, Identity identity);

}  // namespace dts::gateway
