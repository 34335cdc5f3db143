// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "dts/error.h"
#include "gateway/access/access_control.h"
#include "gateway/http/server.h"

namespace dts::gateway {

/// The words of `dts-gateway serve`, and what they mean. Every one may also stand in a file (`--config`, TOML, table [serve]).
struct Options {
  std::string listen = "127.0.0.1:8080";  ///< "ADDRESS:PORT", "[::1]:PORT"; port 0: any
  std::string certificate_file;
  std::string key_file;
  std::vector<std::string> host_names;
  std::string users_file;
  std::string local_role;       ///< "viewer", "operator", "engineer" or "none"; empty: "operator" without a users file, else "none"
  std::string web_root;         ///< Empty: beside the program (share/dts-gateway/web), else /usr/share/dts-gateway/web
  std::string cache_directory;  ///< Empty: $CACHE_DIRECTORY (systemd), else a temporary one
  bool has_metrics = true;      ///< GET /metrics
  std::string control_endpoint;
  std::string data_endpoint;
};

/// What the options come to. Each fails with InvalidArgument and what to write instead.
/// Anything but loopback needs TLS and users: what is typed into a login must not be readable on the way.
[[nodiscard]] client::Result<ServerOptions> server_options(const Options& options);
[[nodiscard]] client::Result<AccessOptions> access_options(const Options& options);
/// The folder with index.html. NotFound when there is none.
[[nodiscard]] client::Result<std::string> web_root(const Options& options);

}  // namespace dts::gateway
