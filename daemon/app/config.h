// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/log.h"
#include "files/toml_reader.h"
#include "pipeline/rig_config.h"
#include "session/protocol.h"
#include "session/storage.h"

namespace dts::app {

/// How the sample and publish threads are scheduled. The USB event thread runs one above `fifo_priority`, acquire threads at it, pipelines
/// one below, the publish thread two and libzmq's own thread three below: whoever is nearer to the device goes first.
struct RealtimeConfig {
  int fifo_priority = 50;  ///< 0: SCHED_FIFO is not asked for.
  bool locks_memory = true;
  std::vector<int> cpus;  ///< Cores for the sample and publish threads; empty: all.

  [[nodiscard]] core::ThreadPolicy policy(int steps_below) const;
};

/// Addresses for clients on other machines, which need keys.
struct NetworkConfig {
  std::string control_endpoint;
  std::string data_endpoint;
};

/// A rig whose own files are fine, and where the daemon's file names it.
struct ConfiguredRig {
  pipeline::RigConfig rig;
  std::string rig_file;
  files::Problem where;  ///< Position of its [[rig]] table; no text.
};

/// The daemon's configuration: checked values only.
struct DaemonConfig {
  std::string runtime_directory;
  std::string control_endpoint;
  std::string data_endpoint;
  std::optional<NetworkConfig> network;  ///< Absent: this machine only.
  std::string key_directory;             ///< Of the daemon's own key and its clients' (daemon/access).
  core::LogLevel log_level = core::LogLevel::Info;
  RealtimeConfig realtime;
  session::StorageConfig storage;
  std::vector<session::Protocol> protocols;  ///< "free" is always among them.
  std::vector<ConfiguredRig> rigs;
};

struct LoadedConfig {
  DaemonConfig config;
  files::Problems problems;  ///< All of them; the configuration may be used only when there is none.
};

/// Reads the daemon's configuration and every rig and sensor file it names (see config/dtsd.toml).
[[nodiscard]] LoadedConfig load_config(const std::string& file);

}  // namespace dts::app
