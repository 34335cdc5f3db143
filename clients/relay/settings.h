// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "settings/shared_settings.h"

namespace dts::relay {

/// What dts-relay needs of dtsd.toml. All values are checked.
struct Settings {
  core::LogLevel log_level = core::LogLevel::Info;
  settings::LocalEndpoints local;                    ///< Where dtsd listens.
  std::optional<settings::RemoteEndpoints> network;  ///< Where dts-relay listens; absent: nowhere.
  std::string key_directory;
};

/// Reads dtsd's configuration file. Adds errors of the tables that dts-relay reads to `problems`: dtsd reports those of the others.
[[nodiscard]] Settings load_settings(const std::string& file, files::Problems& problems);

}  // namespace dts::relay
