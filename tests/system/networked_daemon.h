// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

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

/// A daemon that listens for clients with keys.
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
};

}  // namespace dts::test
