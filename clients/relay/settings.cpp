// SPDX-License-Identifier: Apache-2.0
#include "relay/settings.h"

namespace dts::relay {

Settings load_settings(const std::string& file, files::Problems& problems) {
  Settings loaded;
  const auto table = files::parse_toml(file, problems);
  if (!table) return loaded;
  files::TomlReader top(&*table, "", file, problems);
  loaded.log_level = settings::read_log_level(top.table("log"));
  loaded.local = settings::read_endpoints(top.table("endpoints"));
  loaded.network = settings::read_network(top);
  files::TomlReader storage = top.table("storage");
  loaded.key_directory = settings::key_directory(settings::read_recordings_directory(storage));
  return loaded;
}

}  // namespace dts::relay
