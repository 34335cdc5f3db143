// SPDX-License-Identifier: Apache-2.0
#include "dts/endpoints.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <map>

#include "unit/libdts/fake_daemon.h"

namespace dts::client {
namespace {

Environment environment(const std::map<std::string, std::string>& variables) {
  return [variables](const char* name) {
    const auto found = variables.find(name);
    return found == variables.end() ? nullptr : found->second.c_str();
  };
}

const std::filesystem::path kNowhere = "/nonexistent/dtsd";

TEST(Endpoints, NothingGiven_UsersRuntimeDirectory) {
  const auto found = find_endpoints({}, environment({{"XDG_RUNTIME_DIR", "/run/user/5"}}), kNowhere);

  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->control, "ipc:///run/user/5/dtsd/control.sock");
  EXPECT_EQ(found->data, "ipc:///run/user/5/dtsd/data.sock");
}

TEST(Endpoints, NoRuntimeDirectoryAtAll_DirectoryOfTheUserBelowTmp) {
  const auto found = find_endpoints({}, environment({}), kNowhere);

  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->control, "ipc:///tmp/dtsd-" + std::to_string(::geteuid()) + "/control.sock");
}

TEST(Endpoints, SystemDaemonHasSockets_WinsOverTheUsers) {
  const testing::TemporaryDirectory system;
  std::ofstream(system.path() / "control.sock") << "";

  const auto found = find_endpoints({}, environment({{"XDG_RUNTIME_DIR", "/run/user/5"}}), system.path());

  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->control, system.endpoint("control.sock"));
}

TEST(Endpoints, RuntimeDirectoryOfTheDaemonGiven_WinsOverDefaults) {
  const auto found = find_endpoints({}, environment({{"DTSD_RUNTIME_DIR", "/srv/x"}, {"XDG_RUNTIME_DIR", "/run/user/5"}}), kNowhere);

  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->data, "ipc:///srv/x/data.sock");
  EXPECT_EQ(found->origin, "DTSD_RUNTIME_DIR");
}

TEST(Endpoints, ControlAddressInTheEnvironment_DecidesTheDataAddress) {
  const auto found = find_endpoints({}, environment({{"DTSD_CONTROL", "ipc:///a/control.sock"}, {"DTSD_RUNTIME_DIR", "/srv/x"}}), kNowhere);

  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->data, "ipc:///a/data.sock");
}

TEST(Endpoints, GivenControlAddress_IsNotMixedWithTheEnvironmentsDataAddress) {
  const auto found =
      find_endpoints({.control = "ipc:///a/control.sock", .data = {}}, environment({{"DTSD_DATA", "ipc:///b/data.sock"}}), kNowhere);

  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->control, "ipc:///a/control.sock");
  EXPECT_EQ(found->data, "ipc:///a/data.sock");
}

TEST(Endpoints, OnlyTcpControlAddress_DataAddressStaysUnknown) {
  const auto found = find_endpoints({.control = "tcp://127.0.0.1:5555", .data = {}}, environment({}), kNowhere);

  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->data, "");
}

TEST(Endpoints, ImpossibleAddresses_AreRefusedWithTheReason) {
  for (const std::string address : {"floor", "ipc://relative/control.sock", "tcp://127.0.0.1", "tcp://:1", "udp://1.2.3.4:5", "ipc://"}) {
    const auto found = find_endpoints({.control = address, .data = {}}, environment({}), kNowhere);
    ASSERT_FALSE(found.has_value()) << address;
    EXPECT_EQ(found.error().code, ErrorCode::InvalidArgument);
    EXPECT_NE(found.error().what.find("--endpoint"), std::string::npos);
  }
}

TEST(Endpoints, SocketPathTooLong_IsRefused) {
  const std::string at_limit = "/" + std::string(92, 'a') + "/control.sock";

  EXPECT_TRUE(find_endpoints({.control = "ipc://" + at_limit, .data = {}}, environment({}), kNowhere).has_value());
  EXPECT_FALSE(find_endpoints({.control = "ipc:///a" + at_limit, .data = {}}, environment({}), kNowhere).has_value());
}

TEST(Probe, NoSocket_SaysSoAndHowToStart) {
  const testing::TemporaryDirectory directory;

  const auto outcome = probe(directory.endpoint("control.sock"));

  ASSERT_FALSE(outcome.has_value());
  EXPECT_EQ(outcome.error().code, ErrorCode::Unreachable);
  EXPECT_NE(outcome.error().what.find(directory.endpoint("control.sock")), std::string::npos);
  EXPECT_NE(outcome.error().hint.find("start it"), std::string::npos);
}

TEST(Probe, SomebodyListens_Succeeds) {
  const testing::TemporaryDirectory directory;
  testing::FakePublisher publisher(directory.endpoint("data.sock"));

  EXPECT_TRUE(probe(directory.endpoint("data.sock")).has_value());
}

}  // namespace
}  // namespace dts::client
