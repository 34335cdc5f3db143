// SPDX-License-Identifier: Apache-2.0
// The end of the gateway: soon, whatever is under way, and without leaving anything behind.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iterator>

#include "dts/v1/gateway.pb.h"
#include "gateway/gateway_process.h"
#include "gateway/raw_client.h"
#include "system/notify_socket.h"

namespace dts::test {
namespace {

constexpr std::chrono::seconds kServiceEnd{10};  // then systemd kills it: TimeoutStopSec of dts-gateway.service

class GatewayEnd : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(daemon_.is_ready()) << daemon_.log();
    ASSERT_NE(gateway_.port(), 0) << gateway_.log();
  }
  [[nodiscard]] std::ptrdiff_t temporary_folders() const {
    return std::distance(std::filesystem::directory_iterator(gateway_.directory() / "tmp"), std::filesystem::directory_iterator());
  }

  DaemonProcess daemon_;
  GatewayProcess gateway_{daemon_, {"--local-role", "operator"}};
};

class GatewayEndBySignal : public GatewayEnd, public testing::WithParamInterface<int> {};

TEST_P(GatewayEndBySignal, WithNobodyThere_EndsAndLeavesNothing) {
  EXPECT_EQ(temporary_folders(), 1);

  const auto before = std::chrono::steady_clock::now();
  EXPECT_EQ(gateway_.stop(GetParam()), 0) << gateway_.log();

  EXPECT_LT(std::chrono::steady_clock::now() - before, kServiceEnd);
  EXPECT_EQ(temporary_folders(), 0);
}

INSTANTIATE_TEST_SUITE_P(All, GatewayEndBySignal, testing::Values(SIGINT, SIGTERM, SIGHUP));

TEST(GatewayService, TellsTheServiceManagerWhenItServes) {
  const DaemonProcess daemon;
  const NotifySocket notify(daemon.directory() / "notify-gateway");
  ::setenv("NOTIFY_SOCKET", (daemon.directory() / "notify-gateway").c_str(), 1);
  const GatewayProcess gateway(daemon, {"--local-role", "operator"});
  ::unsetenv("NOTIFY_SOCKET");
  EXPECT_TRUE(eventually([&] { return notify.says_ready(20); })) << gateway.log();
}

TEST_F(GatewayEnd, WithACommandUnderWay_DoesNotWaitForTheDaemon) {
  auto tab = open_websocket(gateway_.port());
  ASSERT_TRUE(tab.has_value());
  v1::FromBrowser command;
  command.mutable_request()->set_request_id("r1");
  command.mutable_request()->mutable_stop_session()->set_rig("floor");
  v1::FromBrowser probe;
  probe.mutable_clock_probe()->set_browser_ms(1.0);
  daemon_.signal(SIGSTOP);
  tab->send(frame(kFin | kBinary, command.SerializeAsString()) + frame(kFin | kBinary, probe.SerializeAsString()));
  v1::FromGateway answer;
  while (!answer.has_clock_answer()) {  // then it has the command as well
    const auto got = read_frame(*tab);
    ASSERT_TRUE(got && answer.ParseFromString(got->payload));
  }

  const auto before = std::chrono::steady_clock::now();
  EXPECT_EQ(gateway_.stop(), 0) << gateway_.log();
  const auto took = std::chrono::steady_clock::now() - before;
  daemon_.signal(SIGCONT);

  EXPECT_LT(took, kServiceEnd) << "the daemon has 20 s to stop a session";
}

}  // namespace
}  // namespace dts::test
