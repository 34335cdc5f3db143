// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/console.h"
#include "gateway/options.h"

namespace dts::fleet::desk {

struct Options {
  gateway::Options server;
  std::vector<std::string> nats_servers;
  std::string nats_ca_file;   ///< Empty: no TLS, on loopback addresses.
  std::string nats_key_file;  ///< The dashboard's own nkey.
  std::string database;       ///< As libpq understands it. Its role needs to read only.
};

/// Serves the dashboard of the centre until SIGINT, SIGTERM or SIGHUP. Prints its address on `console.talk`. Returns the exit status.
[[nodiscard]] int serve(const Options& options, cli::Console& console);

}  // namespace dts::fleet::desk
