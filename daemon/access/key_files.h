// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "access/client_key.h"
#include "files/toml_reader.h"

namespace dts::access {

inline constexpr std::size_t kMostKeys = 1000;

/// The daemon's own CURVE key pair in Z85. Clients have the public key and use it to verify the daemon.
struct ServerKey {
  std::string public_key;
  std::string secret_key;
};

/// Reads "public_key" and "secret_key" of `file`, which must be a pair. Adds errors to `problems`; no message contains a key.
[[nodiscard]] std::optional<ServerKey> read_server_key(const std::string& file, files::Problems& problems);
[[nodiscard]] std::string server_key_text(const ServerKey& key);

/// Reads the [[client]] tables of `file`: name, role, public_key, created. No two may have the same name or the same key.
[[nodiscard]] std::optional<std::vector<ClientKey>> read_client_keys(const std::string& file, files::Problems& problems);
/// Reads the same from a text in memory.
[[nodiscard]] std::optional<std::vector<ClientKey>> parse_client_keys(std::string_view text, const std::string& name,
                                                                      files::Problems& problems);
[[nodiscard]] std::string client_keys_text(const std::vector<ClientKey>& keys);

}  // namespace dts::access
