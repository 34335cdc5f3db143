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

TEST(Endpoint, LocalOnes_AreAccepted) {
  EXPECT_TRUE(check_endpoint("ipc:///run/dtsd/data.sock"));
  EXPECT_TRUE(check_endpoint("tcp://127.0.0.1:5555"));
}

TEST(Endpoint, WhatOthersCanReach_IsRefused) {
  for (const char* endpoint : {"tcp://0.0.0.0:5555", "tcp://*:5555", "tcp://192.168.1.4:5555", "tcp://example.org:5555", "tcp://eth0:5555",
                               "tcp://localhost:5555", "tcp://[::1]:5555"}) {
    EXPECT_FALSE(check_endpoint(endpoint)) << endpoint;
  }
}

TEST(Endpoint, MalformedOnes_AreRefused) {
  for (const char* endpoint : {"", "ipc://", "ipc://relative.sock", "tcp://127.0.0.1", "tcp://127.0.0.1:", "tcp://127.0.0.1:0",
                               "tcp://127.0.0.1:70000", "tcp://127.0.0.1:80x", "udp://127.0.0.1:1", "inproc://x"}) {
    EXPECT_FALSE(check_endpoint(endpoint)) << endpoint;
  }
  EXPECT_FALSE(check_endpoint("ipc:///" + std::string(200, 'a')));
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
