// SPDX-License-Identifier: Apache-2.0
#include "ipc/endpoint.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>

namespace dts::ipc {
namespace {

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
