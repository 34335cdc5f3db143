// SPDX-License-Identifier: Apache-2.0
#include "app/config.h"

#include <algorithm>
#include <filesystem>
#include <thread>

#include "files/protocol_file.h"
#include "files/rig_file.h"
#include "settings/folders.h"

namespace dts::app {
namespace {

constexpr std::size_t kLongestRigName = 32;
constexpr int kStepsBelow = 2;  // our lowest thread priority is fifo_priority minus this

bool is_rig_name(const std::string& name) {
  return !name.empty() && name.size() <= kLongestRigName && name != "dtsd" &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-") == std::string::npos;
}

RealtimeConfig read_realtime(files::TomlReader reader) {
  RealtimeConfig realtime;
  realtime.fifo_priority = static_cast<int>(reader.integer("fifo_priority", realtime.fifo_priority, 0, 95));
  if (realtime.fifo_priority > 0 && realtime.fifo_priority <= kStepsBelow) {
    reader.report("fifo_priority",
                  "fifo_priority must be 0 (off) or above " + std::to_string(kStepsBelow) + ": two threads use the priorities below it");
  }
  realtime.locks_memory = reader.boolean("lock_memory", realtime.locks_memory);
  const auto cores = static_cast<std::int64_t>(std::max(1U, std::thread::hardware_concurrency()));
  for (const std::int64_t cpu : reader.integers("cpus", 0, cores - 1)) realtime.cpus.push_back(static_cast<int>(cpu));
  reader.finish();
  return realtime;
}

bool read_devices(files::TomlReader reader) {
  const bool allows_programs = reader.boolean("allow_exec", false);
  reader.finish();
  return allows_programs;
}

session::StorageConfig read_storage(files::TomlReader reader) {
  session::StorageConfig storage;
  storage.directory = settings::read_recordings_directory(reader);
  storage.refuse_below_min = reader.number("refuse_below_min", storage.refuse_below_min, 0.0, 100'000.0);
  storage.warn_below_min = reader.number("warn_below_min", storage.warn_below_min, 0.0, 100'000.0);
  storage.resume_within_min = reader.number("resume_within_min", storage.resume_within_min, 0.0, 1440.0);
  storage.stop_below_mib = reader.number("stop_below_mib", storage.stop_below_mib, 0.0, 1e6);
  if (storage.warn_below_min < storage.refuse_below_min) {
    reader.report("warn_below_min",
                  "warn_below_min is less than refuse_below_min: dtsd would reject sessions before it warns; raise warn_below_min");
  }
  reader.finish();
  return storage;
}

/// Returns the text of a hint; reports one that is too long or has characters that are not visible.
std::string read_hint(files::TomlReader& reader, const char* key, std::string_view otherwise) {
  std::string hint = reader.text(key, otherwise);
  if (auto plain = session::check_plain_text(key, hint, files::kLongestText); !plain) reader.report(key, plain.error().what);
  return hint;
}

/// Reads the clinic's rule for subject IDs; by default there is none.
void read_subject_rule(files::TomlReader& reader, session::LabelRule& rule) {
  rule.subject_hint = read_hint(reader, "subject_hint", session::kGeneralSubjectHint);
  const std::string given = reader.text("subject_pattern", "");
  if (!reader.has("subject_pattern")) {
    if (reader.has("subject_hint")) reader.report("subject_hint", "subject_hint explains subject_pattern, which is missing");
    return;
  }
  auto pattern = core::TextPattern::compile(given);
  if (!pattern) return reader.report("subject_pattern", pattern.error().what);
  rule.subject_pattern = std::move(*pattern);
}

/// Reads [privacy]. A clinic that sets a rule of its own also says what it allows; else the general sentence is the hint.
session::LabelRule read_privacy(files::TomlReader reader) {
  session::LabelRule rule;
  auto pattern = core::TextPattern::compile(reader.text("label_pattern", session::kDefaultLabelPattern));
  if (pattern) {
    rule.pattern = std::move(*pattern);
  } else {
    reader.report("label_pattern", pattern.error().what);
  }
  const bool is_default = !reader.has("label_pattern");
  rule.hint = read_hint(reader, "label_hint", is_default ? session::kDefaultLabelHint : session::kGeneralLabelHint);
  read_subject_rule(reader, rule);
  reader.finish();
  return rule;
}

/// Reads `[protocols] directory`, relative to the configuration file. The default is the folder "protocols" beside that file; it may be
/// missing.
std::vector<session::Protocol> read_protocols(files::TomlReader reader, files::Problems& problems) {
  const std::string given = reader.text("directory", "protocols");
  const auto folder = (std::filesystem::path(reader.file()).parent_path() / given).lexically_normal();
  if (reader.has("directory") && !std::filesystem::is_directory(folder)) {
    reader.report("directory", folder.string() + " is not a folder");
  }
  reader.finish();
  return files::read_protocols(folder.string(), problems);
}

void read_rig(files::TomlReader& reader, DaemonConfig& config, files::Problems& problems) {
  for (const char* key : {"name", "file", "device"}) reader.require(key);
  const std::string name = reader.text("name", "");
  const std::string file = reader.text("file", "");
  const std::string device = reader.text("device", "");
  reader.finish();
  if (reader.has("name") && !is_rig_name(name)) {
    reader.report("name", "a rig's name has 1..32 lower-case letters, digits, '_' or '-', and is not \"dtsd\"");
  }
  if (std::ranges::find(config.rigs, name, [](const ConfiguredRig& other) { return other.rig.name; }) != config.rigs.end()) {
    reader.report("name", "another rig is named '" + name + "' too");
    return;
  }
  if (file.empty()) return;
  const auto rig_file = (std::filesystem::path(reader.file()).parent_path() / file).lexically_normal().string();
  if (!reader.can_read("file", rig_file)) return;
  const std::size_t problems_before = problems.size();
  pipeline::RigConfig rig = files::read_rig_file(rig_file, problems);
  if (problems.size() > problems_before || device.empty()) return;  // the problems are reported, and the rig cannot be built
  rig.name = name;
  rig.device_uri = device;
  if (auto definition = files::rig_definition(rig_file)) rig.definition = std::move(*definition);
  rig.policy = config.realtime.policy(0);
  config.rigs.push_back({.rig = std::move(rig), .rig_file = rig_file, .where = reader.position("device")});
}

}  // namespace

core::ThreadPolicy RealtimeConfig::policy(int steps_below) const {
  return {.fifo_priority = fifo_priority == 0 ? 0 : fifo_priority - steps_below, .cpus = {}};
}

LoadedConfig load_config(const std::string& file) {
  LoadedConfig loaded;
  DaemonConfig& config = loaded.config;
  config.runtime_directory = settings::runtime_directory();
  const auto table = files::parse_toml(file, loaded.problems);
  if (!table) return loaded;
  files::TomlReader top(&*table, "", file, loaded.problems);
  config.log_level = settings::read_log_level(top.table("log"));
  config.endpoints = settings::read_endpoints(top.table("endpoints"));
  config.realtime = read_realtime(top.table("realtime"));
  config.allows_programs = read_devices(top.table("devices"));
  config.network = settings::read_network(top);
  config.storage = read_storage(top.table("storage"));
  config.key_directory = settings::key_directory(config.storage.directory);
  config.label_rule = read_privacy(top.table("privacy"));
  config.protocols = read_protocols(top.table("protocols"), loaded.problems);
  for (files::TomlReader& rig : top.tables("rig")) read_rig(rig, config, loaded.problems);
  top.finish();
  return loaded;
}

}  // namespace dts::app
