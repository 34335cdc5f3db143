// SPDX-License-Identifier: Apache-2.0
#include "fleet/desk/settings.h"

#include <filesystem>

#include "files/whole_file.h"

namespace dts::fleet::desk {
namespace {

constexpr std::size_t kMostCaBytes = 1024 * 1024;

/// Returns the name of a file, relative to the folder of the configuration; empty if the key is absent.
std::string path_of(files::TomlReader& reader, std::string_view key) {
  const std::string text = reader.text(key, "");
  return text.empty() ? text : (std::filesystem::path(reader.file()).parent_path() / text).lexically_normal().string();
}

}  // namespace

Settings load_settings(const std::string& file, files::Problems& problems) {
  Settings loaded;
  const auto table = files::parse_toml(file, problems);
  if (!table) return loaded;
  files::TomlReader top(&*table, "", file, problems);
  files::TomlReader nats = top.table("nats");
  for (const char* key : {"servers", "key"}) nats.require(key);
  loaded.servers = nats.texts("servers", {});
  loaded.key_file = path_of(nats, "key");
  if (const std::string ca_file = path_of(nats, "ca"); !ca_file.empty()) {
    auto text = files::read_whole_file(ca_file, kMostCaBytes);
    if (text)
      loaded.ca_pem = std::move(*text);
    else
      nats.report("ca", "cannot read '" + ca_file + "': " + text.error().what);
  }
  files::TomlReader database = top.table("database");
  database.require("connection");
  loaded.connection = database.text("connection", "");
  return loaded;
}

}  // namespace dts::fleet::desk
