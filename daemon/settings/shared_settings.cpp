// SPDX-License-Identifier: Apache-2.0
#include "settings/shared_settings.h"

#include <cstdlib>
#include <filesystem>

#include "settings/endpoint.h"
#include "settings/folders.h"

namespace dts::settings {
namespace {

std::string read_endpoint(files::TomlReader& reader, std::string_view key, const std::string& fallback) {
  const std::string endpoint = reader.text(key, fallback);
  if (auto valid = check_endpoint(endpoint); !valid) reader.report(key, core::to_string(valid.error()));
  return endpoint;
}

std::string read_remote_endpoint(files::TomlReader& reader, std::string_view key) {
  reader.require(key);
  const std::string endpoint = reader.text(key, "");
  if (!reader.has(key)) return endpoint;
  if (auto valid = check_remote_endpoint(endpoint); !valid) reader.report(key, core::to_string(valid.error()));
  return endpoint;
}

std::string absolute_name(const std::filesystem::path& path) {
  std::error_code error;
  const auto whole = std::filesystem::absolute(path, error);  // fails if there is no working directory
  return (error ? path : whole).lexically_normal().string();
}

}  // namespace

core::LogLevel read_log_level(files::TomlReader reader) {
  const std::string level = reader.choice("level", {"info", "debug", "warning", "error"});
  reader.finish();
  if (level == "debug") return core::LogLevel::Debug;
  if (level == "warning") return core::LogLevel::Warning;
  return level == "error" ? core::LogLevel::Error : core::LogLevel::Info;
}

LocalEndpoints read_endpoints(files::TomlReader reader) {
  const std::string folder = runtime_directory();
  LocalEndpoints endpoints{.control = read_endpoint(reader, "control", "ipc://" + folder + "/control.sock"),
                           .data = read_endpoint(reader, "data", "ipc://" + folder + "/data.sock")};
  if (endpoints.control == endpoints.data) reader.report("data", "control and data need different endpoints");
  reader.finish();
  return endpoints;
}

std::optional<RemoteEndpoints> read_network(files::TomlReader& top) {
  if (!top.has("network")) return std::nullopt;
  files::TomlReader reader = top.table("network");
  RemoteEndpoints network{.control = read_remote_endpoint(reader, "control"), .data = read_remote_endpoint(reader, "data")};
  if (reader.has("data") && network.control == network.data) reader.report("data", "control and data need different ports");
  reader.finish();
  return network;
}

std::string read_recordings_directory(files::TomlReader& storage) {
  const std::string given = storage.text("directory", "");
  const auto folder = std::filesystem::path(storage.file()).parent_path();
  const char* const state_dir = std::getenv("DTSD_STATE_DIR");
  const bool is_overridden = state_dir != nullptr && *state_dir != '\0';
  // Absolute, because the catalogue and clients store the paths of recordings and may run in another folder.
  return absolute_name(given.empty() || is_overridden ? std::filesystem::path(state_directory()) : folder / given);
}

std::string key_directory(const std::string& recordings_directory) { return recordings_directory + "/keys"; }

}  // namespace dts::settings
