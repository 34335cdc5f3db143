// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "access/client_key.h"
#include "files/toml_reader.h"

namespace dts::access {

inline constexpr std::size_t kMostKeys = 1000;

/// The daemon's own CURVE key pair, Z85. Clients carry the public half and so know whom they talk to.
struct ServerKey {
  std::string public_key;
  std::string secret_key;
};

/// "public_key" and "secret_key" of `file`, which must fit each other. What is wrong is added to `problems`, without any key in it.
[[nodiscard]] std::optional<ServerKey> read_server_key(const std::string& file, files::Problems& problems);
[[nodiscard]] std::string server_key_text(const ServerKey& key);

/// The [[client]] tables of `file`: name, role, public_key, created. Names and keys must differ from each other.
[[nodiscard]] std::optional<std::vector<ClientKey>> read_client_keys(const std::string& file, files::Problems& problems);
/// The same of a text that is in memory.
[[nodiscard]] std::optional<std::vector<ClientKey>> parse_client_keys(std::string_view text, const std::string& name,
                                                                      files::Problems& problems);
[[nodiscard]] std::string client_keys_text(const std::vector<ClientKey>& keys);

}  // namespace dts::access
