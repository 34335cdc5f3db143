// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "device/device.h"
#include "pipeline/rig_config.h"
#include "session/protocol.h"

namespace dts::golden {

/// The model that the device with the recorded scans names.
inline constexpr const char* kRecordedModel = "Recorded scans";

/// One channel of one scan, as the file has it.
struct Sample {
  double value = 0.0;
  std::uint8_t quality = 0;
};

/// The scans that a device gave: the file <case>.scans.
struct Scans {
  std::vector<device::ChannelDescription> channels;
  std::vector<std::vector<Sample>> rows;
};

/// One line of a case: "run 200", "ask tare { rig: \"floor\" }".
struct Step {
  std::string verb;
  std::string rest;
  int line = 0;
};

/// A channel that is held at a value while the scans are recorded.
struct Hold {
  std::size_t channel = 0;
  std::size_t from = 0;
  std::size_t to = 0;
  double value = 0.0;
};

/// A case: the rig, how its scans were made, and what happens. README.md describes the file.
struct Case {
  std::string name;
  pipeline::RigConfig rig;
  std::vector<session::Protocol> protocols;
  std::string sim;                ///< Address of the simulator that gave the scans.
  std::vector<device::Cue> cues;  ///< Given to it while it was recorded.
  std::vector<Hold> holds;
  std::vector<Step> steps;

  [[nodiscard]] std::size_t scan_count() const;
};

/// Folder of the cases.
[[nodiscard]] std::string folder();
[[nodiscard]] std::string read_text(const std::string& file);
void write_text(const std::string& file, const std::string& text);
/// Names of all cases, sorted.
[[nodiscard]] std::vector<std::string> case_names();
/// Throws std::runtime_error with file and line if the file is not in order.
[[nodiscard]] Case read_case(const std::string& name);
[[nodiscard]] Scans read_scans(const std::string& name);
/// Records the scans from the simulator that the case names and writes <case>.scans.
void record_scans(const Case& golden);

}  // namespace dts::golden
