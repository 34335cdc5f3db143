// SPDX-License-Identifier: Apache-2.0
#include "settings/endpoint.h"

#include <gtest/gtest.h>

#include <string>

namespace dts::settings {
namespace {

std::string refusal(const core::Status& status) { return status ? "" : core::to_string(status.error()); }

TEST(Endpoint, LocalAndRemoteOnes_AreToldApartAndRefusedWithAReason) {
  const std::string network =
      " is a network address, and dtsd itself has none (write it under [network], where dts-relay serves clients with keys; here only "
      "ipc:// is allowed)";
  const std::string no_port = " has no port (write tcp://*:5555)";
  const std::string port = ": the port must be 1..65535";
  const std::string relative = ": the socket path must be absolute";
  const std::string no_tcp = " is not tcp:// (write tcp://*:5555, or one address of this machine)";
  const std::string no_address =
      " names no address of this machine (write tcp://*:5555, or the IPv4 address in digits: the address of a name can change)";
  const std::string longest = "ipc:///" + std::string(106, 'a');
  const struct {
    std::string endpoint, local, remote;  // what is said of it, "" if it is accepted
  } rows[]{{"ipc:///run/dtsd/data.sock", "", no_tcp},
           {longest, "", no_tcp},
           {longest + "a", ": a socket path has at most 107 bytes (choose a shorter runtime directory)", no_tcp},
           {"ipc://", relative, no_tcp},
           {"ipc://relative.sock", relative, no_tcp},
           {"", " is not ipc://", no_tcp},
           {"udp://127.0.0.1:1", " is not ipc://", no_tcp},
           {"tcp://127.0.0.1:1", network, ""},
           {"tcp://127.0.0.1:65535", network, ""},
           {"tcp://192.168.1.4:5555", network, ""},
           {"tcp://*:5555", network, ""},
           {"tcp://0.0.0.0:5555", network, ""},
           {"tcp://localhost:5555", network, no_address},
           {"tcp://[::1]:5555", network, no_address},
           {"tcp://:5555", network, no_address},
           {"tcp://127.0.0.1", network, no_port},
           {"tcp://127.0.0.1:", network, port},
           {"tcp://127.0.0.1:0", network, port},
           {"tcp://127.0.0.1:65536", network, port},
           {"tcp://127.0.0.1:80x", network, port}};
  for (const auto& row : rows) {
    const std::string start = "'" + row.endpoint + "'";
    EXPECT_EQ(refusal(check_endpoint(row.endpoint)), row.local.empty() ? "" : start + row.local);
    EXPECT_EQ(refusal(check_remote_endpoint(row.endpoint)), row.remote.empty() ? "" : start + row.remote);
  }
}

}  // namespace
}  // namespace dts::settings
