// SPDX-License-Identifier: Apache-2.0
#include "ipc/endpoint.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <zmq.hpp>

#include "ipc/control_socket.h"

namespace dts::ipc {
namespace {

std::string refusal(const core::Status& status) { return status ? "" : core::to_string(status.error()); }

TEST(Endpoint, LocalAndRemoteOnes_AreToldApartAndRefusedWithAReason) {
  const std::string reachable =
      " is reachable from other machines, which needs client keys (write it under [network], where clients need keys; here only "
      "ipc:// and 127.0.0.1 are allowed)";
  const std::string no_port = " has no port (write tcp://127.0.0.1:5555)";
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
           {"", " is neither ipc:// nor tcp://", no_tcp},
           {"udp://127.0.0.1:1", " is neither ipc:// nor tcp://", no_tcp},
           {"tcp://127.0.0.1:1", "", ""},
           {"tcp://127.0.0.1:65535", "", ""},
           {"tcp://192.168.1.4:5555", reachable, ""},
           {"tcp://*:5555", reachable, ""},
           {"tcp://0.0.0.0:5555", reachable, ""},
           {"tcp://localhost:5555", reachable, no_address},
           {"tcp://[::1]:5555", reachable, no_address},
           {"tcp://:5555", reachable, no_address},
           {"tcp://127.0.0.1", no_port, no_port},
           {"tcp://127.0.0.1:", port, port},
           {"tcp://127.0.0.1:0", port, port},
           {"tcp://127.0.0.1:65536", port, port},
           {"tcp://127.0.0.1:80x", port, port}};
  for (const auto& row : rows) {
    const std::string start = "'" + row.endpoint + "'";
    EXPECT_EQ(refusal(check_endpoint(row.endpoint)), row.local.empty() ? "" : start + row.local);
    EXPECT_EQ(refusal(check_remote_endpoint(row.endpoint)), row.remote.empty() ? "" : start + row.remote);
  }
}

class SocketFile : public ::testing::Test {
 protected:
  SocketFile() {
    std::string name = "/tmp/dts-endpoint-XXXXXX";
    directory_ = mkdtemp(name.data());
    address_.sun_family = AF_UNIX;
    std::strncpy(address_.sun_path, (directory_ / "s").c_str(), sizeof address_.sun_path - 1);
    listener_ = ::socket(AF_UNIX, SOCK_STREAM, 0);
    ::bind(listener_, reinterpret_cast<const sockaddr*>(&address_), sizeof address_);
    ::listen(listener_, 1);
  }
  ~SocketFile() override {
    ::close(listener_);
    std::filesystem::remove_all(directory_);
  }
  std::filesystem::path directory_;
  sockaddr_un address_{};
  int listener_ = -1;
};

TEST(ControlSocketBind, AddressThatThisMachineDoesNotHave_SaysWhatToWrite) {
  zmq::context_t context{2};  // the second thread is for other machines
  std::array<char, 41> public_key{};
  std::array<char, 41> secret_key{};
  ASSERT_EQ(zmq_curve_keypair(public_key.data(), secret_key.data()), 0);

  const auto bound = ControlSocket::bind(context, RemoteEndpoint{"tcp://192.0.2.1:5555", {public_key.data(), secret_key.data()}});

  ASSERT_FALSE(bound);
  EXPECT_NE(bound.error().hint.find("tcp://*:PORT"), std::string::npos) << core::to_string(bound.error());
}

TEST_F(SocketFile, SomebodyListens_IsInUse) {
  const auto free = check_not_in_use("ipc://" + (directory_ / "s").string());

  ASSERT_FALSE(free);
  EXPECT_EQ(free.error().code, core::ErrorCode::WrongState);
}

TEST_F(SocketFile, OrdinaryFile_IsNotReplaced) {
  std::ofstream(directory_ / "precious.txt") << "x";

  EXPECT_FALSE(check_not_in_use("ipc://" + (directory_ / "precious.txt").string()));
}

TEST_F(SocketFile, LeftoverOfADeadDaemon_IsFree) {
  ::close(listener_);
  listener_ = -1;

  EXPECT_TRUE(check_not_in_use("ipc://" + (directory_ / "s").string()));
}

}  // namespace
}  // namespace dts::ipc
