// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "lsl/lsl_peer.h"
#include "system/daemon_process.h"

namespace dts::test {

/// Sets LSL's own configuration for this process and those that it starts: only this machine, and only streams of this process and its
/// children. liblsl reads lsl_api.cfg in the working directory, which becomes a new folder. Call it before the library is loaded. Throws if
/// it cannot write the file.
void isolate_lsl();

/// dts-lsl as a child process beside a daemon; ended with this object.
class LslProcess {
 public:
  /// `lines`: of [lsl] besides the library; `tables`: what follows. Returns when the program says READY or has ended.
  explicit LslProcess(const DaemonProcess& daemon, const std::string& lines = "", const std::string& tables = "");
  ~LslProcess();
  LslProcess(const LslProcess&) = delete;
  LslProcess& operator=(const LslProcess&) = delete;

  void start();
  /// Returns its exit code, or 128 + signal.
  int end(int signal);
  [[nodiscard]] bool is_ready() const noexcept { return process_->is_ready(); }
  [[nodiscard]] bool is_running() const { return process_->is_running(); }
  [[nodiscard]] pid_t pid() const noexcept { return process_->pid(); }
  [[nodiscard]] std::string log() const;

 private:
  const DaemonProcess& daemon_;
  std::optional<ServiceProcess> process_;
};

/// Sets markers in dtsd until one arrives at the inlet of the rig's events, and receives all of them: an outlet may begin to send to a new
/// inlet somewhat after the inlet is open. Returns false if none arrives.
[[nodiscard]] bool is_connected(const DaemonProcess& daemon, Inlet& events);

/// Runs dts-lsl to its end.
[[nodiscard]] Finished run_lsl(const std::vector<std::string>& arguments, const std::vector<std::string>& environment = {});

}  // namespace dts::test
