// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dts/control_client.h"
#include "dts/subscriber.h"

namespace dts::test {

/// How long anything may take before a test gives up; generous, because sanitizers and a busy machine slow things down.
inline constexpr std::chrono::seconds kPatience{100};

/// Polls `condition` until it holds or kPatience is over.
[[nodiscard]] bool eventually(const std::function<bool()>& condition);

/// A finished program: exit status and what it said.
struct Finished {
  int status = -1;  ///< Exit code, or 128 + signal.
  std::string out;
  std::string err;
};

/// Runs a program to its end (it is killed after kPatience).
[[nodiscard]] Finished run_program(const std::vector<std::string>& arguments, const std::vector<std::string>& environment = {});

[[nodiscard]] std::string read_file(const std::filesystem::path& path);

/// A program that reports READY to its service manager, as a child process. The owner must end it.
class ServiceProcess {
 public:
  /// Starts the program; returns when it says READY or has ended. Appends what it says to `log`; `notify`: path for the socket.
  ServiceProcess(const std::vector<std::string>& arguments, std::vector<std::string> environment, const std::filesystem::path& log,
                 const std::filesystem::path& notify);

  [[nodiscard]] bool is_ready() const noexcept { return is_ready_; }
  [[nodiscard]] bool is_running() const;
  [[nodiscard]] pid_t pid() const noexcept { return pid_; }
  /// Does nothing if the program has ended.
  void signal(int number) const;
  /// Waits for the end; exit code, or 128 + signal.
  [[nodiscard]] int wait();

 private:
  pid_t pid_ = -1;
  bool is_ready_ = false;
  std::optional<int> exit_status_;
};

/// dtsd as a child process in a runtime directory of its own; ended and removed with this object.
class DaemonProcess {
 public:
  /// One more rig, like the shipped one where a field is empty.
  struct FurtherRig {
    std::string name;
    std::string device;
    std::string acquire{};  ///< As in `Options`.
    std::string stages{};
    std::string file = "floor-sim.toml";  ///< Of config/rigs.
  };
  struct Options {
    std::string device = "sim:floor?seed=7";
    std::string acquire;  ///< Lines of the rig's [acquire] table.
    std::string stages;   ///< Replaces the [[stage]] tables.
    std::string daemon;   ///< Lines in front of [[rig]] in the daemon's file.
    std::vector<FurtherRig> further_rigs{};
    std::string program = DTSD_PROGRAM;  ///< Benchmarks also run the dtsd of an older build.
  };

  /// Writes the configuration of a rig "floor" like the shipped one (and further ones) and starts the daemon; returns when it says READY
  /// or has ended.
  explicit DaemonProcess(const Options& options);
  DaemonProcess();
  ~DaemonProcess();
  DaemonProcess(const DaemonProcess&) = delete;
  DaemonProcess& operator=(const DaemonProcess&) = delete;

  [[nodiscard]] bool is_ready() const noexcept { return process_->is_ready(); }
  [[nodiscard]] bool is_running() const { return process_->is_running(); }
  [[nodiscard]] pid_t pid() const noexcept { return process_->pid(); }
  void signal(int number) const { process_->signal(number); }
  /// Waits for the end; exit code, or 128 + signal.
  [[nodiscard]] int wait() { return process_->wait(); }
  /// Starts it again with the same files.
  void restart();

  [[nodiscard]] const std::filesystem::path& directory() const noexcept { return directory_; }
  /// Recordings and catalogue.
  [[nodiscard]] std::filesystem::path state_directory() const { return directory_ / "state"; }
  [[nodiscard]] std::string config_file() const { return directory_ / "dtsd.toml"; }
  [[nodiscard]] std::string control_endpoint() const { return "ipc://" + (directory_ / "control.sock").string(); }
  [[nodiscard]] std::string data_endpoint() const { return "ipc://" + (directory_ / "data.sock").string(); }
  [[nodiscard]] std::string log() const;
  /// Variables for the daemon and for programs that share its folders.
  [[nodiscard]] std::vector<std::string> environment() const;

  [[nodiscard]] client::ControlClient control() const;
  [[nodiscard]] client::Subscriber subscribe(std::vector<std::string> topics, client::Mode mode = client::Mode::All) const;
  /// Runs dtsctl against this daemon.
  [[nodiscard]] Finished ctl(std::vector<std::string> arguments) const;

 private:
  void write_files(const Options& options) const;

  std::string program_;
  std::filesystem::path directory_;
  std::optional<ServiceProcess> process_;
};

/// Resident memory of a process, kB.
[[nodiscard]] long resident_kb(pid_t pid);

}  // namespace dts::test
