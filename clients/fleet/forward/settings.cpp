// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/settings.h"

#include <array>
#include <charconv>
#include <filesystem>
#include <system_error>
#include <utility>

#include "fleet/wire/subjects.h"

namespace dts::fleet::forward {
namespace {

constexpr double kBitsPerByte = 8.0;
constexpr double kLowestRate = 1000.0;  // bytes/s
constexpr double kHighestRate = 1e10;
constexpr std::size_t kMostFields = 64;
constexpr std::size_t kMostServers = 16;
constexpr int kMinutesPerHour = 60;

std::optional<int> two_digits(std::string_view text, int largest) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_whole = error == std::errc{} && end == text.data() + text.size();
  return text.size() == 2 && is_whole && number >= 0 && number <= largest ? std::optional(number) : std::nullopt;
}

std::optional<std::chrono::minutes> time_of_text(std::string_view text) {
  if (text.size() != 5 || text[2] != ':') return std::nullopt;
  const auto hours = two_digits(text.substr(0, 2), 23);
  const auto minutes = two_digits(text.substr(3), 59);
  if (!hours || !minutes) return std::nullopt;
  return std::chrono::minutes(*hours * kMinutesPerHour + *minutes);
}

/// Returns the path, relative to the folder of the configuration file.
std::string beside(const std::string& config, const std::string& path) {
  return (std::filesystem::path(config).parent_path() / path).string();
}

std::optional<double> read_rate(files::TomlReader& reader, std::string_view key) {
  if (!reader.has(key)) return std::nullopt;
  const auto rate = rate_of_text(reader.short_text(key));
  if (!rate) reader.report(key, std::string(key) + " must be a rate of at least 8 kbit/s, such as \"4 Mbit/s\" or \"500 kbit/s\"");
  return rate;
}

UploadLimits read_upload(files::TomlReader reader) {
  UploadLimits limits{.rate = read_rate(reader, "max_rate"), .rate_in_session = read_rate(reader, "max_rate_in_session")};
  if (reader.has("only_between")) {
    limits.hours = hours_of_text(reader.short_text("only_between"));
    if (!limits.hours) reader.report("only_between", "only_between must be two different times of the day, such as \"20:00-06:00\"");
  }
  reader.finish();
  return limits;
}

wire::SendRules read_rules(files::TomlReader reader) {
  wire::SendRules rules{.labels = reader.boolean("send_labels", false)};
  for (std::string& field : reader.texts("send_fields", {})) rules.fields.insert(std::move(field));
  if (rules.fields.size() > kMostFields) reader.report("send_fields", "send_fields has more than 64 fields");
  reader.finish();
  return rules;
}

void read_enrolment(const std::string& file, Settings& settings, files::Problems& problems) {
  const auto table = files::parse_toml(file, problems);
  if (!table) return;
  files::TomlReader reader(&*table, "", file, problems);
  reader.require("clinic");
  reader.require("servers");
  settings.clinic = reader.short_text("clinic");
  if (reader.has("clinic") && !wire::is_clinic_name(settings.clinic)) {
    reader.report("clinic", "clinic must be 1 to 32 of a-z, 0-9 and -. Ask the centre for the enrolment file again");
  }
  settings.servers = reader.texts("servers", {});
  if (reader.has("servers") && (settings.servers.empty() || settings.servers.size() > kMostServers)) {
    reader.report("servers", "servers must have 1 to 16 addresses, such as \"tls://centre.example.org:4222\"");
  }
  settings.ca_pem = reader.text("ca", "");
  reader.finish();
}

}  // namespace

bool Hours::contains(std::chrono::minutes time_of_day) const noexcept {
  return from < to ? time_of_day >= from && time_of_day < to : time_of_day >= from || time_of_day < to;
}

std::optional<double> rate_of_text(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, double>, 3> kUnits{{{" kbit/s", 1e3}, {" Mbit/s", 1e6}, {" Gbit/s", 1e9}}};
  for (const auto& [unit, bits] : kUnits) {
    if (!text.ends_with(unit)) continue;
    const std::string_view digits = text.substr(0, text.size() - unit.size());
    double number = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number, std::chars_format::fixed);
    if (error != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
    const double rate = number * bits / kBitsPerByte;
    return rate >= kLowestRate && rate <= kHighestRate ? std::optional(rate) : std::nullopt;
  }
  return std::nullopt;
}

std::optional<Hours> hours_of_text(std::string_view text) {
  if (text.size() != 11 || text[5] != '-') return std::nullopt;
  const auto from = time_of_text(text.substr(0, 5));
  const auto to = time_of_text(text.substr(6));
  if (!from || !to || *from == *to) return std::nullopt;
  return Hours{.from = *from, .to = *to};
}

Settings load_settings(const std::string& file, bool is_enrolled, files::Problems& problems) {
  Settings settings;
  const auto table = files::parse_toml(file, problems);
  if (!table) return settings;
  files::TomlReader reader(&*table, "", file, problems);
  reader.require("key");
  settings.key_file = beside(file, reader.text("key", ""));
  settings.state_folder = reader.text("state", "/var/lib/dts-forward");
  const std::string enrolment = reader.text("enrolment", "");
  if (is_enrolled) {
    reader.require("enrolment");
    const std::string path = beside(file, enrolment);
    std::error_code unknown;
    if (reader.has("enrolment") && !std::filesystem::exists(path, unknown) && !unknown) {
      reader.report("enrolment", path + " does not exist: the centre makes it with dts-fleet clinic add");
    } else if (reader.has("enrolment") && reader.can_read("enrolment", path)) {
      read_enrolment(path, settings, problems);
    }
  }
  files::TomlReader daemon = reader.table("daemon");
  settings.daemon = {.control = daemon.text("control", ""), .data = daemon.text("data", "")};
  daemon.finish();
  settings.upload = read_upload(reader.table("upload"));
  settings.rules = read_rules(reader.table("privacy"));
  files::TomlReader live = reader.table("live");
  settings.is_live_allowed = live.boolean("allowed", true);
  live.finish();
  reader.finish();
  return settings;
}

}  // namespace dts::fleet::forward
