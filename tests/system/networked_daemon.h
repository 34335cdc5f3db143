// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <optional>
#include <string>
#include <vector>

#include "system/daemon_process.h"

namespace dts::test {

/// A TCP port that was free a moment ago.
inline int free_port() {
  const int probe = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  EXPECT_EQ(::bind(probe, reinterpret_cast<sockaddr*>(&address), size), 0);
  EXPECT_EQ(::getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size), 0);
  ::close(probe);
  return ntohs(address.sin_port);
}

inline std::string address_of(int port) { return "tcp://127.0.0.1:" + std::to_string(port); }

/// dts-relay as a child process beside a daemon; killed with this object if it still runs.
class RelayProcess {
 public:
  explicit RelayProcess(const DaemonProcess& daemon) : daemon_(daemon) { start(); }
  ~RelayProcess() { end(SIGTERM); }
  RelayProcess(const RelayProcess&) = delete;
  RelayProcess& operator=(const RelayProcess&) = delete;

  /// Starts it; returns when it says READY or has ended.
  void start() {
    process_.emplace(std::vector<std::string>{DTS_RELAY_PROGRAM, "--config", daemon_.config_file()}, daemon_.environment(),
                     daemon_.directory() / "relay.log", daemon_.directory() / "relay-notify");
  }
  /// Returns its exit code, or 128 + signal.
  int end(int signal) {
    process_->signal(signal);
    return process_->wait();
  }
  [[nodiscard]] bool is_ready() const noexcept { return process_->is_ready(); }
  [[nodiscard]] bool is_running() const { return process_->is_running(); }
  [[nodiscard]] pid_t pid() const noexcept { return process_->pid(); }
  [[nodiscard]] std::string log() const { return read_file(daemon_.directory() / "relay.log"); }

 private:
  const DaemonProcess& daemon_;
  std::optional<ServiceProcess> process_;
};

/// A daemon with a relay that listens for clients with keys.
class NetworkedDaemon : public ::testing::Test {
 protected:
  NetworkedDaemon()
      : daemon_({.acquire = {},
                 .stages = {},
                 .daemon = "[network]\ncontrol = \"" + address_of(control_) + "\"\ndata = \"" + address_of(data_) + "\"\n"}) {}

  /// Makes a key on the daemon's machine; the name of its file.
  std::string new_key(const std::string& name, const std::string& role) {
    const std::string file = (daemon_.directory() / (name + ".key")).string();
    const Finished made = daemon_.ctl({"key", "new", name, "--role", role, "--host", "127.0.0.1", "--out", file});
    EXPECT_EQ(made.status, 0) << made.err;
    return file;
  }
  /// The same as a client library takes it.
  client::Key key(const std::string& name, const std::string& role) { return client::read_key(new_key(name, role)).value(); }

  int control_ = free_port();
  int data_ = free_port();
  DaemonProcess daemon_;
  RelayProcess relay_{daemon_};
};

}  // namespace dts::test
