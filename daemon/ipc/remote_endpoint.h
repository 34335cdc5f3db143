// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <zmq.hpp>

#include "access/key_files.h"
#include "core/result.h"

namespace dts::ipc {

/// An address that other machines may reach, and the key pair by which they know this daemon. Without a key of their own nobody gets in.
struct RemoteEndpoint {
  std::string endpoint;
  access::ServerKey key;
};

/// Has what `socket` binds from now on served by the first of the context's network threads, which strangers never keep busy.
void use_local_thread(zmq::socket_t& socket);

/// Binds `socket` at it, beside whatever it is bound to already: options count for listeners that come after them. Gives the address as
/// libzmq calls it. Its network thread is another than that of the local listeners. Throws zmq::error_t.
std::string bind_remote(zmq::socket_t& socket, const RemoteEndpoint& remote);

/// Ends every connection through the listener `bound` (a name that bind_remote gave) and listens again; the local ones are not touched.
/// False: the address could not be taken again, and nobody listens there; try again later.
[[nodiscard]] bool drop_connections(zmq::socket_t& socket, const std::string& bound) noexcept;

}  // namespace dts::ipc
