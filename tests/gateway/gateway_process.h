// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "system/daemon_process.h"

namespace dts::test {

/// dts-gateway as a child process in front of a daemon, with a dashboard of one page; ended and removed with this object.
class GatewayProcess {
 public:
  /// `options`: words after "serve", besides those that say where everything is.
  GatewayProcess(const DaemonProcess& daemon, const std::vector<std::string>& options);
  ~GatewayProcess();
  GatewayProcess(const GatewayProcess&) = delete;
  GatewayProcess& operator=(const GatewayProcess&) = delete;

  /// 0: it did not come up.
  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  [[nodiscard]] pid_t pid() const noexcept { return pid_; }
  [[nodiscard]] bool is_running() const;
  /// Asks it to end; its exit status, -1 when it crashed, was gone already or does not end.
  [[nodiscard]] int stop(int signal = SIGTERM);
  [[nodiscard]] std::string log() const;
  /// Holds the folder that is served, and "tmp" for what the gateway makes.
  [[nodiscard]] const std::filesystem::path& directory() const noexcept { return directory_; }

 private:
  std::filesystem::path directory_;
  pid_t pid_ = -1;
  std::uint16_t port_ = 0;
};

/// Counts the scans of "floor/cop" that reach a subscriber, and those that do not, from its start on.
class ScanWatch {
 public:
  explicit ScanWatch(const DaemonProcess& daemon);

  struct Count {
    std::uint64_t scans = 0;
    std::uint64_t lost = 0;
    std::uint64_t gaps = 0;  ///< Segments after the first, and whatever the device lost.
  };
  /// Ends the count.
  [[nodiscard]] Count stop();

 private:
  Count count_;
  std::jthread thread_;
};

}  // namespace dts::test
