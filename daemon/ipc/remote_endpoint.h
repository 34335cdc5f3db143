// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <zmq.hpp>

#include "access/key_files.h"
#include "core/result.h"

namespace dts::ipc {

/// An address for other machines, and the key pair that identifies this daemon to them. Clients without their own key cannot connect.
struct RemoteEndpoint {
  std::string endpoint;
  access::ServerKey key;
};

/// Makes the first network thread of the context serve all addresses that `socket` binds from now on. Remote clients never use that thread,
/// so they cannot keep it busy.
void use_local_thread(zmq::socket_t& socket);

/// Binds `socket` to `remote` too; options apply only to later listeners, so earlier ones do not change. Returns the address as libzmq
/// names it. The listener uses another network thread than the local ones. Throws zmq::error_t.
std::string bind_remote(zmq::socket_t& socket, const RemoteEndpoint& remote);

/// Ends every connection through the listener `bound` (returned by bind_remote) and listens again. Does not change local connections.
/// Returns false if the address could not be bound again: then nothing listens there; try again later.
[[nodiscard]] bool drop_connections(zmq::socket_t& socket, const std::string& bound) noexcept;

}  // namespace dts::ipc
