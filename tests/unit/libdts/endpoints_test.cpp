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

TEST(Endpoints, WhatIsGivenMorePrecisely_Wins) {
  const testing::TemporaryDirectory system;
  std::ofstream(system.path() / "control.sock") << "";
  const std::pair xdg("XDG_RUNTIME_DIR", "/run/user/5");
  const std::pair runtime("DTSD_RUNTIME_DIR", "/srv/x");
  struct Row {
    EndpointWishes wishes;
    std::map<std::string, std::string> variables;
    std::filesystem::path system;
    Endpoints expected;
  };
  const std::string in_tmp = "/tmp/dtsd-" + std::to_string(::geteuid());
  const std::vector<Row> rows{
      {{}, {}, kNowhere, {"ipc://" + in_tmp + "/control.sock", "ipc://" + in_tmp + "/data.sock", in_tmp}},
      {{}, {xdg}, kNowhere, {"ipc:///run/user/5/dtsd/control.sock", "ipc:///run/user/5/dtsd/data.sock", "XDG_RUNTIME_DIR"}},
      {{}, {xdg}, system.path(), {system.endpoint("control.sock"), system.endpoint("data.sock"), system.path()}},
      {{}, {xdg, runtime}, system.path(), {"ipc:///srv/x/control.sock", "ipc:///srv/x/data.sock", "DTSD_RUNTIME_DIR"}},
      {{}, {{"DTSD_CONTROL", "ipc:///a/control.sock"}, runtime}, kNowhere, {"ipc:///a/control.sock", "ipc:///a/data.sock", "DTSD_CONTROL"}},
      {{}, {{"DTSD_DATA", "ipc:///a/data.sock"}, runtime}, kNowhere, {"ipc:///a/control.sock", "ipc:///a/data.sock", "DTSD_DATA"}},
      {{.control = "ipc:///a/control.sock", .data = {}},
       {{"DTSD_DATA", "ipc:///b/data.sock"}},
       kNowhere,
       {"ipc:///a/control.sock", "ipc:///a/data.sock", "--endpoint"}},
      {{.control = {}, .data = "ipc:///a/data.sock"}, {}, kNowhere, {"ipc:///a/control.sock", "ipc:///a/data.sock", "--data"}},
      {{.control = "tcp://127.0.0.1:5555", .data = {}}, {}, kNowhere, {"tcp://127.0.0.1:5555", "", "--endpoint"}},
      {{.control = "tcp://127.0.0.1:5555", .data = {}},
       {{"DTSD_DATA", "tcp://127.0.0.1:5556"}},
       kNowhere,
       {"tcp://127.0.0.1:5555", "tcp://127.0.0.1:5556", "--endpoint"}}};
  for (const Row& row : rows) {
    const auto found = find_endpoints(row.wishes, environment(row.variables), row.system);
    ASSERT_TRUE(found.has_value()) << row.expected.control;
    EXPECT_EQ(std::tie(found->control, found->data, found->origin), std::tie(row.expected.control, row.expected.data, row.expected.origin));
  }
}

TEST(Endpoints, ImpossibleAddresses_AreRefusedWithTheReason) {
  for (const std::string address :
       {"floor", "ipc://relative/control.sock", "tcp://127.0.0.1", "tcp://127.0.0.1:", "tcp://:1", "udp://1.2.3.4:5", "ipc://"}) {
    const auto found = find_endpoints({.control = address, .data = {}}, environment({}), kNowhere);
    ASSERT_FALSE(found.has_value()) << address;
    EXPECT_EQ(found.error().code, ErrorCode::InvalidArgument);
    EXPECT_NE(found.error().what.find("--endpoint"), std::string::npos);
  }
}

TEST(Endpoints, SocketPathTooLong_IsRefused) {
  const std::string at_limit = "/" + std::string(92, 'a') + "/control.sock";

  EXPECT_TRUE(find_endpoints({.control = "ipc://" + at_limit, .data = {}}, environment({}), kNowhere).has_value());
  const std::string beyond = "ipc:///a" + at_limit;
  EXPECT_EQ(find_endpoints({.control = beyond, .data = {}}, environment({}), kNowhere).error(),
            (Error{ErrorCode::InvalidArgument, "'" + beyond + "' (from --endpoint): a socket path has at most 107 bytes",
                   "choose a shorter runtime directory"}));
}

TEST(Probe, NoSocket_SaysSoAndHowToStartUntilSomebodyListens) {
  const testing::TemporaryDirectory directory;

  const auto outcome = probe(directory.endpoint("control.sock"));

  ASSERT_FALSE(outcome.has_value());
  EXPECT_EQ(outcome.error().code, ErrorCode::Unreachable);
  EXPECT_NE(outcome.error().what.find(directory.endpoint("control.sock")), std::string::npos);
  EXPECT_NE(outcome.error().hint.find("start it"), std::string::npos);

  const testing::FakePublisher publisher(directory.endpoint("control.sock"));
  EXPECT_TRUE(probe(directory.endpoint("control.sock")).has_value());
}

}  // namespace
}  // namespace dts::client
