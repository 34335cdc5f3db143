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
  const std::string at_limit = "/" + std::string(92, 'a') + "/control.sock";
  const Error none{ErrorCode::InvalidArgument, "", ""};
  const Error no_address{ErrorCode::InvalidArgument, " is not an address", "write ipc:///path/control.sock or tcp://host:port"};
  const Error relative{ErrorCode::InvalidArgument, ": the socket path must be absolute", "write ipc:///run/dtsd/control.sock"};
  const Error too_long{ErrorCode::InvalidArgument, ": the socket path is longer than 107 bytes", "choose a shorter runtime directory"};
  const std::vector<std::pair<std::string, Error>> rows{{"ipc://@abstract", none},
                                                        {"tcp://h:1", none},
                                                        {"ipc://" + at_limit, none},
                                                        {"ipc:///a" + at_limit, too_long},
                                                        {"ipc://relative/control.sock", relative},
                                                        {"ipc://", relative},
                                                        {"floor", no_address},
                                                        {"tcp://127.0.0.1", no_address},
                                                        {"tcp://127.0.0.1:", no_address},
                                                        {"tcp://:1", no_address},
                                                        {"udp://1.2.3.4:5", no_address}};
  for (const auto& [address, expected] : rows) {
    for (const bool is_data : {false, true}) {
      const EndpointWishes wishes{.control = is_data ? "tcp://h:1" : address, .data = is_data ? address : "tcp://h:1"};
      const auto found = find_endpoints(wishes, environment({}), kNowhere);
      EXPECT_EQ(found.has_value(), expected.what.empty()) << address;
      const std::string what = "'" + address + "' (from --endpoint)" + expected.what;
      EXPECT_EQ(found ? none : found.error(), found ? none : (Error{expected.code, what, expected.hint}));
    }
  }
}

TEST(Probe, EachStateOfASocket_IsSaid) {
  const testing::TemporaryDirectory directory;
  const std::string endpoint = directory.endpoint("control.sock");
  const Error missing{ErrorCode::Unreachable, "no daemon at " + endpoint + ": the socket does not exist",
                      "start it: systemctl start dtsd, or dtsd --config FILE; if it uses another directory (scripts/demo prints it), set "
                      "DTSD_RUNTIME_DIR or give --endpoint"};
  EXPECT_EQ(probe(endpoint).error(), missing);
  std::ofstream(directory.path() / "file") << "";
  EXPECT_EQ(probe(directory.endpoint("file/control.sock")).error().hint, missing.hint);
  {
    const testing::FakePublisher publisher(endpoint);
    EXPECT_TRUE(probe(endpoint).has_value());
  }
  std::ofstream(directory.path() / "control.sock") << "";
  EXPECT_EQ(probe(endpoint).error(),
            (Error{ErrorCode::Unreachable, "no daemon at " + endpoint + ": the socket exists, but no program listens on it",
                   "start it: systemctl start dtsd; find out why it ended: journalctl -u dtsd"}));
  for (const std::string other : {"tcp://127.0.0.1:1", "ipc://", "ipc://@abstract"}) EXPECT_TRUE(probe(other)) << other;
  EXPECT_FALSE(probe("ipc:///" + std::string(106, 'x')));
  EXPECT_TRUE(probe("ipc:///" + std::string(107, 'x'))) << "libzmq refuses it";
}

}  // namespace
}  // namespace dts::client
