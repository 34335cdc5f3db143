// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "dts/error.h"
#include "dts/export.h"

namespace dts::client {

/// Lets a client on another machine prove its identity and check that it talks to the right daemon (CURVE, ZeroMQ RFC 26). All keys are 40
/// characters of Z85.
struct Key {
  std::string name;               ///< Name of the client, as the daemon lists it: 1..32 characters of a-z 0-9 . _ -
  std::string public_key;         ///< The client's public key; the daemon stores it.
  std::string secret_key;         ///< Never leaves this machine.
  std::string server_public_key;  ///< The daemon's public key.
  std::string control;            ///< The daemon's control address: "tcp://clinic-7:5555"
  std::string data;               ///< The daemon's data address: "tcp://clinic-7:5556"
};

/// Returns a new key pair with this name; the fields about the daemon are empty. Fails with Failed if libzmq has no CURVE. Thread: any.
[[nodiscard]] DTS_API Result<Key> new_key(const std::string& name);

/// Reads a file in the format of `key_text`. Fails with InvalidArgument, naming file, line and column, for any other content, also if there
/// is no such file, and with NotAllowed if users other than the file's owner may read or write it. Thread: any.
[[nodiscard]] DTS_API Result<Key> read_key(const std::string& file);
/// Returns the content of a key file (TOML), which `read_key` reads. Contains the secret key. Thread: any.
[[nodiscard]] DTS_API std::string key_text(const Key& key);
/// Writes a new file that only its owner can read. Fails with WrongState if the file exists (it may be the only copy of a secret), and with
/// Failed if it cannot be written. Thread: any.
[[nodiscard]] DTS_API Result<void> write_new_key(const std::string& file, const Key& key);

}  // namespace dts::client
