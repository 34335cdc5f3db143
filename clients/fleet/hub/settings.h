// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/log.h"
#include "core/result.h"
#include "files/toml_reader.h"
#include "fleet/hub/quota.h"
#include "fleet/s3/settings.h"

namespace dts::fleet::hub {

/// A dashboard of the centre (dts-fleet-gateway) as a user of nats-server.
struct DashboardKey {
  std::string public_key;
  std::vector<std::string> clinics;  ///< Whose rigs it may watch. Empty: all.
};

/// hub.toml. All values are checked; names of files are relative to the file's folder.
struct Settings {
  core::LogLevel log_level = core::LogLevel::Info;
  std::string name;  ///< Of this hub: each process needs another one.

  std::vector<std::string> servers;         ///< "tls://127.0.0.1:4222"
  std::vector<std::string> public_servers;  ///< As the clinics reach them; for enrolment files.
  std::string ca_file;                      ///< Empty: no TLS, on loopback addresses.
  std::string key_file;                     ///< The hub's nkey; made by `dts-fleet users` if there is none.
  std::string users_file;                   ///< Empty: another hub writes it.
  std::vector<DashboardKey> dashboards;
  std::string pid_file;  ///< Of nats-server, which reads the users file again at SIGHUP; empty: systemd sends it.

  std::string connection;  ///< Of PostgreSQL.

  std::string directory;           ///< Of recordings; with `s3`: of staged files and of the journal of erasures.
  std::optional<s3::Settings> s3;  ///< Where recordings are, if not in the directory.
  double full_at_percent = 95.0;
  QuotaFigures quota;

  std::string metrics_address;  ///< Empty: no /metrics.
  std::uint16_t metrics_port = 0;
};

[[nodiscard]] Settings load_settings(const std::string& file, files::Problems& problems);

/// Reads the certificates in `settings.ca_file`. Fails with InvalidArgument.
[[nodiscard]] core::Result<std::string> read_ca(const Settings& settings);

}  // namespace dts::fleet::hub
