// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/settings.h"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "files/whole_file.h"
#include "fleet/wire/nkey.h"
#include "fleet/wire/subjects.h"

namespace dts::fleet::hub {
namespace {

constexpr std::int64_t kMostBytes = 1'000'000'000'000'000;
constexpr std::int64_t kMostQuotaRows = 100'000'000'000;
constexpr double kLeastMessagesPerS = 1.0;
constexpr double kMostMessagesPerS = 100'000.0;
constexpr std::size_t kMostCaBytes = 1024 * 1024;

/// Returns the name of a file, relative to the folder of the configuration; empty if the key is absent.
std::string file_name(files::TomlReader& reader, std::string_view key) {
  const std::string text = reader.text(key, "");
  if (text.empty()) return text;
  std::error_code error;
  const auto folder = std::filesystem::absolute(reader.file(), error).parent_path();
  return (folder / text).lexically_normal().string();
}

core::LogLevel read_level(files::TomlReader reader) {
  const std::string level = reader.choice("level", {"info", "debug", "warning", "error"});
  reader.finish();
  if (level == "debug") return core::LogLevel::Debug;
  if (level == "warning") return core::LogLevel::Warning;
  return level == "error" ? core::LogLevel::Error : core::LogLevel::Info;
}

void read_nats(files::TomlReader reader, Settings& settings) {
  for (const char* key : {"servers", "key"}) reader.require(key);
  settings.servers = reader.texts("servers", {});
  settings.public_servers = reader.texts("public_servers", settings.servers);
  settings.ca_file = file_name(reader, "ca");
  settings.key_file = file_name(reader, "key");
  settings.users_file = file_name(reader, "users_file");
  settings.pid_file = file_name(reader, "pid_file");
  if (settings.servers.empty() && reader.has("servers")) reader.report("servers", "needs at least one server: [\"tls://127.0.0.1:4222\"]");
  reader.finish();
}

DashboardKey read_dashboard(files::TomlReader& reader) {
  DashboardKey read;
  reader.require("key");
  read.public_key = reader.text("key", "");
  read.clinics = reader.texts("clinics", {});
  if (reader.has("key") && !wire::is_public_nkey(read.public_key)) {
    reader.report("key", "is not a public key: \"U...\", as dts-fleet-gateway key prints it");
  }
  if (reader.has("clinics") && read.clinics.empty()) reader.report("clinics", "names no clinic; remove the line to allow all clinics");
  for (const std::string& clinic : read.clinics) {
    if (!wire::is_clinic_name(clinic)) reader.report("clinics", "'" + clinic + "' is not a name of a clinic: a-z, 0-9 and -");
  }
  reader.finish();
  return read;
}

QuotaFigures read_quota(files::TomlReader reader) {
  QuotaFigures quota;
  const auto read = [&reader](const char* key, std::uint64_t& figure, std::int64_t most) {
    figure = static_cast<std::uint64_t>(reader.integer(key, static_cast<std::int64_t>(figure), 1, most));
  };
  read("bytes_a_day", quota.bytes_a_day, kMostBytes);
  read("staged_bytes", quota.staged_bytes, kMostBytes);
  quota.messages_per_s = reader.number("messages_per_s", quota.messages_per_s, kLeastMessagesPerS, kMostMessagesPerS);
  read("sessions", quota.sessions, kMostQuotaRows);
  read("recordings", quota.recordings, kMostQuotaRows);
  read("rows", quota.rows, kMostQuotaRows);
  read("erased_sessions", quota.erased_sessions, kMostQuotaRows);
  reader.finish();
  return quota;
}

/// Splits "127.0.0.1:9464".
void read_metrics(files::TomlReader reader, Settings& settings) {
  const std::string listen = reader.text("listen", "");
  reader.finish();
  if (listen.empty()) return;
  const std::size_t colon = listen.rfind(':');
  settings.metrics_address = listen.substr(0, colon);
  in_addr parsed{};
  bool is_sound = colon != std::string::npos && ::inet_pton(AF_INET, settings.metrics_address.c_str(), &parsed) == 1;
  if (is_sound) {
    const char* const end = listen.data() + listen.size();
    const auto [stop, error] = std::from_chars(listen.data() + colon + 1, end, settings.metrics_port);
    is_sound = error == std::errc() && stop == end;
  }
  if (!is_sound) reader.report("listen", "'" + listen + "' is not an IPv4 address with a port: \"127.0.0.1:9464\"");
}

}  // namespace

Settings load_settings(const std::string& file, files::Problems& problems) {
  Settings loaded;
  const auto table = files::parse_toml(file, problems);
  if (!table) return loaded;
  files::TomlReader top(&*table, "", file, problems);
  loaded.log_level = read_level(top.table("log"));
  top.require("name");
  loaded.name = top.text("name", "");
  if (top.has("name") && !wire::is_worker_name(loaded.name)) top.report("name", "has 1 to 32 of the characters a-z, 0-9 and -: \"hub-1\"");
  read_nats(top.table("nats"), loaded);
  for (files::TomlReader& dashboard : top.tables("dashboard")) {
    loaded.dashboards.push_back(read_dashboard(dashboard));
    const auto is_same = [&](const DashboardKey& other) { return other.public_key == loaded.dashboards.back().public_key; };
    if (std::count_if(loaded.dashboards.begin(), loaded.dashboards.end(), is_same) > 1)
      dashboard.report("key", "is that of another dashboard");
  }
  files::TomlReader database = top.table("database");
  database.require("connection");
  loaded.connection = database.text("connection", "");
  database.finish();
  files::TomlReader store = top.table("store");
  store.require("directory");
  loaded.directory = file_name(store, "directory");
  if (store.has("s3")) loaded.s3 = s3::read_settings(store.table("s3"));
  loaded.full_at_percent = store.number("full_at_percent", 95.0, 1.0, 100.0);
  store.finish();
  loaded.quota = read_quota(top.table("quota"));
  read_metrics(top.table("metrics"), loaded);
  top.finish();
  return loaded;
}

core::Result<std::string> read_ca(const Settings& settings) {
  if (settings.ca_file.empty()) return std::string();
  auto text = files::read_whole_file(settings.ca_file, kMostCaBytes);
  if (text) return text;
  return core::fail(core::ErrorCode::InvalidArgument, "cannot read '" + settings.ca_file + "': " + text.error().what,
                    "name the certificates of the authority in [nats] ca");
}

}  // namespace dts::fleet::hub
