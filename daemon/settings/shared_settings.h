// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "core/log.h"
#include "files/toml_reader.h"

namespace dts::settings {

/// Addresses of dtsd's own sockets, for this machine.
struct LocalEndpoints {
  std::string control;
  std::string data;
};

/// Addresses for clients on other machines, which need keys. dts-relay listens on them.
struct RemoteEndpoints {
  std::string control;
  std::string data;
};

// The tables of dtsd.toml that dtsd and dts-relay read. Each function reports every error to the reader, and unknown keys of its table.

/// Reads [log].
[[nodiscard]] core::LogLevel read_log_level(files::TomlReader reader);
/// Reads [endpoints]. The defaults are in `runtime_directory()`.
[[nodiscard]] LocalEndpoints read_endpoints(files::TomlReader reader);
/// Reads [network]; nothing if there is no such table.
[[nodiscard]] std::optional<RemoteEndpoints> read_network(files::TomlReader& top);

/// Reads `directory` of [storage], the folder of the recordings, as an absolute path: relative to the file, or `state_directory()` if the
/// key is absent or $DTSD_STATE_DIR is set. Leaves the other keys of the table to the caller.
[[nodiscard]] std::string read_recordings_directory(files::TomlReader& storage);
/// Returns the folder of the keys beside these recordings.
[[nodiscard]] std::string key_directory(const std::string& recordings_directory);

}  // namespace dts::settings
