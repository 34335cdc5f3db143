// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "dts/error.h"

namespace dts::client {

/// With which a client on another machine proves who it is (CURVE, ZeroMQ RFC 26), and knows that it talks to the right daemon. All keys
/// are 40 characters of Z85.
struct Key {
  std::string name;
  std::string public_key;
  std::string secret_key;         ///< Never leaves this machine.
  std::string server_public_key;  ///< Of the daemon.
  std::string control;            ///< Its addresses: "tcp://clinic-7:5555"
  std::string data;
};

/// A fresh pair under a name; the daemon's part is empty. Failed when libzmq has no CURVE.
[[nodiscard]] Result<Key> new_key(const std::string& name);

/// Reads a file that `key_text` made. InvalidArgument, with file, line and column, when it is none; NotAllowed when others than its owner
/// may read it.
[[nodiscard]] Result<Key> read_key(const std::string& file);
[[nodiscard]] std::string key_text(const Key& key);
/// Writes a new file for its owner alone. WrongState when there is one already: it may be the only copy of a secret.
[[nodiscard]] Result<void> write_new_key(const std::string& file, const Key& key);

}  // namespace dts::client
