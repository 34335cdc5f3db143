// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/console.h"
#include "gateway/options.h"

namespace dts::fleet::desk {

struct Options {
  gateway::Options server;
  std::string config;  ///< hub.toml
};

/// Serves the dashboard of the centre until SIGINT, SIGTERM or SIGHUP. Prints its address on `console.talk`. Returns the exit status.
[[nodiscard]] int serve(const Options& options, cli::Console& console);

}  // namespace dts::fleet::desk
