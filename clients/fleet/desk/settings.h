// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "files/toml_reader.h"

namespace dts::fleet::desk {

/// What the dashboard of the centre needs of hub.toml. `dts-hub` checks the whole file.
struct Settings {
  std::vector<std::string> servers;  ///< Of nats-server.
  std::string ca_pem;                ///< Empty: no TLS, on loopback addresses.
  std::string key_file;              ///< The hub's nkey.
  std::string connection;            ///< Of PostgreSQL.
};

[[nodiscard]] Settings load_settings(const std::string& file, files::Problems& problems);

}  // namespace dts::fleet::desk
