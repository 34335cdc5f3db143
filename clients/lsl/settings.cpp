// SPDX-License-Identifier: Apache-2.0
#include "lsl/settings.h"

#include <charconv>
#include <string_view>
#include <system_error>

#include "settings/shared_settings.h"

namespace dts::lsl {
namespace {

constexpr std::size_t kMostNames = 64;
constexpr std::size_t kMostPredicates = 16;
constexpr std::int64_t kLongestBufferS = 3600;
constexpr std::string_view kForbiddenInFolder = "{}\r\n";  // LabRecorder's remote control cannot quote them

void check_count(files::TomlReader& reader, const char* key, const std::vector<std::string>& texts, std::size_t most) {
  if (texts.size() > most) reader.report(key, std::string(key) + " has more than " + std::to_string(most) + " entries");
  for (const std::string& text : texts) {
    if (text.empty()) reader.report(key, std::string(key) + " has an empty entry");
  }
}

/// `markers_from` is one text or a list of texts.
std::vector<std::string> read_predicates(files::TomlReader& reader) {
  const toml::node* const node = reader.node("markers_from");
  if (node != nullptr && node->is_string()) return {reader.text("markers_from", "")};
  return reader.texts("markers_from", {});
}

void read_lsl(files::TomlReader reader, Settings& settings) {
  settings.library = reader.text("library", "");
  settings.rigs = reader.texts("rigs", {});
  settings.streams = reader.texts("streams", {});
  settings.buffer_s = static_cast<std::int32_t>(reader.integer("buffer_s", settings.buffer_s, 1, kLongestBufferS));
  settings.markers_from = read_predicates(reader);
  settings.markers_rig = reader.short_text("markers_rig");
  check_count(reader, "rigs", settings.rigs, kMostNames);
  check_count(reader, "streams", settings.streams, kMostNames);
  check_count(reader, "markers_from", settings.markers_from, kMostPredicates);
  reader.finish();
}

/// Returns the port of "host:port"; nothing for anything else.
std::optional<LabRecorderSettings> address_of(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) return std::nullopt;
  std::uint16_t port = 0;
  const char* const end = text.data() + text.size();
  const auto [parsed, error] = std::from_chars(text.data() + colon + 1, end, port);
  if (error != std::errc{} || parsed != end || port == 0) return std::nullopt;
  return LabRecorderSettings{.host = text.substr(0, colon), .port = port, .folder = {}};
}

std::optional<LabRecorderSettings> read_lab_recorder(files::TomlReader reader) {
  reader.require("address");
  auto settings = address_of(reader.text("address", ""));
  if (reader.has("address") && !settings) {
    reader.report("address", "address must be HOST:PORT of LabRecorder's remote control, such as \"127.0.0.1:22345\"");
  }
  const std::string folder = reader.text("folder", "");
  if (folder.find_first_of(kForbiddenInFolder) != std::string::npos) {
    reader.report("folder", "LabRecorder accepts no { or } and no line break in the name of a folder");
  }
  reader.finish();
  if (settings) settings->folder = folder;
  return settings;
}

/// Time stamps are those of this machine's clock, so the daemon must run here.
std::string read_local(files::TomlReader& reader, const char* key) {
  const std::string endpoint = reader.text(key, "");
  if (!endpoint.empty() && !endpoint.starts_with("ipc://")) {
    reader.report(key, std::string(key) + " must begin with ipc://: dts-lsl runs on the daemon's machine");
  }
  return endpoint;
}

}  // namespace

Settings load_settings(const std::string& file, files::Problems& problems) {
  Settings loaded;
  const auto table = files::parse_toml(file, problems);
  if (!table) return loaded;
  files::TomlReader reader(&*table, "", file, problems);
  loaded.log_level = settings::read_log_level(reader.table("log"));
  files::TomlReader daemon = reader.table("daemon");
  loaded.daemon = {.control = read_local(daemon, "control"), .data = read_local(daemon, "data")};
  daemon.finish();
  read_lsl(reader.table("lsl"), loaded);
  if (reader.has("labrecorder")) loaded.lab_recorder = read_lab_recorder(reader.table("labrecorder"));
  reader.finish();
  return loaded;
}

}  // namespace dts::lsl
