// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "system/daemon_process.h"
#include "usb/host_program/rig_source.h"

namespace dts::emulator {

/// usb_emulator with the real dtsd under it, in a directory of its own; ended and removed with this object.
class EmulatorProcess {
 public:
  struct Options {
    std::string daq = "1608fs-plus";
    std::string uri = "mcc:1608fs-plus?channels=0,1,2,3&range_v=5";
    std::string scene;
    std::string rig_tables;             ///< Appended to the rig's file.
    std::string rig_text{};             ///< The whole file of the rig; empty: the shipped floor platform.
    std::vector<std::string> wiring{};  ///< Further arguments of usb_emulator.
    std::string weights;                ///< Lines of the file "weights.csv" that `scene` may name as $DIR/weights.csv.
  };

  /// Returns when the daemon answers, or after kPatience.
  explicit EmulatorProcess(const Options& options);
  ~EmulatorProcess();
  EmulatorProcess(const EmulatorProcess&) = delete;
  EmulatorProcess& operator=(const EmulatorProcess&) = delete;

  /// Sends a command and returns the answer; empty: none came.
  [[nodiscard]] std::string ask(const std::string& command);
  [[nodiscard]] std::optional<RigSource::Truth> truth_at(std::int64_t monotonic_ns);
  [[nodiscard]] test::Finished ctl(std::vector<std::string> arguments) const;
  [[nodiscard]] client::Subscriber subscribe(std::vector<std::string> topics) const;
  [[nodiscard]] bool is_streaming() const;
  [[nodiscard]] std::string log() const;
  /// Ends both; the daemon's exit status.
  [[nodiscard]] int quit();

 private:
  void write_files(const Options& options) const;
  void spawn(const Options& options);

  std::filesystem::path directory_;
  pid_t pid_ = -1;
  int commands_ = -1;
  int answers_ = -1;
};

}  // namespace dts::emulator
