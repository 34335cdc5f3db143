// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/log.h"
#include "files/toml_reader.h"
#include "pipeline/rig_config.h"
#include "session/label_rule.h"
#include "session/protocol.h"
#include "session/storage.h"
#include "settings/shared_settings.h"

namespace dts::app {

/// How the rigs' threads and the publish thread are scheduled. The priorities relative to `fifo_priority` are: USB event thread +1, rigs'
/// threads 0, publish thread -1, libzmq's own threads -2. A thread nearer to the device has a higher priority.
struct RealtimeConfig {
  int fifo_priority = 50;  ///< 0: do not use SCHED_FIFO.
  bool locks_memory = true;
  std::vector<int> cpus;  ///< Cores for all threads of dtsd, those of libraries too; empty: all.

  [[nodiscard]] core::ThreadPolicy policy(int steps_below) const;
};

/// A rig whose own files have no error, and its place in the daemon's configuration file.
struct ConfiguredRig {
  pipeline::RigConfig rig;
  std::string rig_file;
  files::Problem where;  ///< Position of its [[rig]] table; no text.
};

/// The daemon's configuration. All values are checked.
struct DaemonConfig {
  std::string runtime_directory;
  settings::LocalEndpoints endpoints;
  std::optional<settings::RemoteEndpoints> network;  ///< Where dts-relay listens; absent: this machine only.
  std::string key_directory;                         ///< Folder of the server's key and its clients' keys (daemon/access).
  core::LogLevel log_level = core::LogLevel::Info;
  RealtimeConfig realtime;
  bool allows_programs = false;  ///< Devices may start programs: exec:.
  session::StorageConfig storage;
  std::vector<session::Protocol> protocols;  ///< "free" is always among them.
  session::LabelRule label_rule;
  std::vector<ConfiguredRig> rigs;
};

struct LoadedConfig {
  DaemonConfig config;
  files::Problems problems;  ///< All errors. Use the configuration only if there is none.
};

/// Reads the daemon's configuration and every file that it names (see config/dtsd.toml).
[[nodiscard]] LoadedConfig load_config(const std::string& file);

}  // namespace dts::app
