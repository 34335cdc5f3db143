// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/log.h"
#include "dts/endpoints.h"
#include "files/toml_reader.h"

namespace dts::lsl {

/// Where LabRecorder's remote control listens, and where it puts its files.
struct LabRecorderSettings {
  std::string host;
  std::uint16_t port = 0;
  std::string folder;  ///< Of the machine on which LabRecorder runs; empty: LabRecorder's own.
};

/// The configuration of dts-lsl. All values are checked.
struct Settings {
  core::LogLevel log_level = core::LogLevel::Info;
  client::EndpointWishes daemon;
  std::string library;                    ///< File of liblsl; empty: as the system finds it.
  std::vector<std::string> rigs;          ///< Empty: all.
  std::vector<std::string> streams;       ///< "raw"; empty: all.
  std::int32_t buffer_s = 360;            ///< What an outlet keeps for a slow consumer.
  std::vector<std::string> markers_from;  ///< Predicates of LSL.
  std::string markers_rig;                ///< Gets these markers; empty: every rig.
  std::optional<LabRecorderSettings> lab_recorder;
};

/// Reads the file. Adds each error with its place to `problems`.
[[nodiscard]] Settings load_settings(const std::string& file, files::Problems& problems);

}  // namespace dts::lsl
