// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/App.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "dts/error.h"
#include "gateway/access/access_control.h"
#include "gateway/http/server.h"

namespace dts::gateway {

/// The options of `dts-gateway serve`. Each one can also be set in a file (`--config`, TOML, table [serve]).
struct Options {
  std::string listen = "127.0.0.1:8080";  ///< "ADDRESS:PORT", "[::1]:PORT"; port 0: any free port
  std::string certificate_file;
  std::string key_file;
  std::vector<std::string> host_names;
  std::string users_file;
  std::string local_role;       ///< "viewer", "operator", "engineer" or "none"; empty: "operator" without a users file, otherwise "none"
  std::string web_root;         ///< Empty: next to the program (share/dts-gateway/web), otherwise /usr/share/dts-gateway/web
  std::string cache_directory;  ///< Empty: $CACHE_DIRECTORY (systemd), otherwise a temporary folder
  bool has_metrics = true;      ///< GET /metrics
  std::string control_endpoint;
  std::string data_endpoint;
};

/// Adds the options that a server of the dashboard has: address, TLS, users, files of the dashboard.
void add_server_options(CLI::App& command, Options& options);

/// Derive the settings of the parts from the options. Each fails with InvalidArgument and what to write instead. Any address other than
/// loopback requires TLS and users: passwords must not be readable on the network.
[[nodiscard]] client::Result<ServerOptions> server_options(const Options& options);
[[nodiscard]] client::Result<AccessOptions> access_options(const Options& options);
/// Returns the folder with index.html. Fails with NotFound if there is none.
[[nodiscard]] client::Result<std::string> web_root(const Options& options);

}  // namespace dts::gateway
