// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <zmq.hpp>

#include "dts/key.h"

namespace dts::client {

/// Makes all new connections of `socket` use the key. Throws zmq::error_t.
inline void use(zmq::socket_t& socket, const Key& key) {
  socket.set(zmq::sockopt::curve_serverkey, key.server_public_key);
  socket.set(zmq::sockopt::curve_publickey, key.public_key);
  socket.set(zmq::sockopt::curve_secretkey, key.secret_key);
}

}  // namespace dts::client
