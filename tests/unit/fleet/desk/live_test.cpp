// SPDX-License-Identifier: Apache-2.0
#include "fleet/desk/live.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <optional>

#include "fleet/desk/query_pool.h"
#include "support/nats_server.h"
#include "unit/fleet/desk/fake_clinic.h"
#include "unit/gateway/answered_test.h"
#include "unit/gateway/bus/fake_connection.h"

namespace dts::fleet::desk {
namespace {

using gateway::FakeConnection;
using gateway::say;

std::int64_t utc_ns() { return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count(); }

/// Tabs of a centre whose PostgreSQL does not exist.
class LiveTest : public gateway::IoTest {
 protected:
  void SetUp() override {
    if (!test::NatsServer::program()) GTEST_SKIP() << "nats-server is not installed";
    server_.emplace();
    auto opened = link::Link::open(
        {.servers = {"nats://127.0.0.1:" + std::to_string(server_->port())}, .name = "desk", .inbox_prefix = "_DASHBOARD.x"}, core::Log());
    ASSERT_TRUE(opened);
    link_ = std::move(*opened);
    live_.emplace(io_, *link_, queries_, "1.2.3");
  }
  std::unique_ptr<gateway::Tab> open(const std::string& clinic = "kent") {
    return live_->open_tab({.user = "anna", .role = v1::ROLE_ENGINEER}, clinic, connection_);
  }
  /// Confirms all frames and returns true once one has this topic.
  bool receives(gateway::Tab& tab, const std::string& topic) {
    std::size_t seen = 0;
    return runs_until([&] {
      for (; seen < connection_.sent.size(); ++seen) {
        const v1::FromGateway message = connection_.sent[seen];
        if (!message.has_frame()) continue;
        v1::FromBrowser painted;
        painted.mutable_painted()->set_frame(message.frame().number());
        say(tab, painted);
        for (const v1::Carried& carried : message.frame().messages()) {
          if (carried.topic() == topic) return true;
        }
      }
      return false;
    });
  }
  std::int64_t probe(gateway::Tab& tab) {
    v1::FromBrowser message;
    message.mutable_clock_probe()->set_browser_ms(1.0);
    say(tab, message);
    return connection_.sent.back().clock_answer().host_time_ns();
  }

  std::optional<test::NatsServer> server_{};
  std::unique_ptr<link::Link> link_{};
  QueryPool queries_{io_, "host=/nowhere dbname=none", core::Log()};
  FakeConnection connection_;
  std::optional<Live> live_{};
};

TEST_F(LiveTest, NoNameOfAClinic_ClosesTheConnection) {
  const auto tab = open("../kent");

  EXPECT_EQ(connection_.closed_with, 1008U);
}

TEST_F(LiveTest, Commands_AreRejectedForEveryRole) {
  const auto tab = open();
  v1::FromBrowser message;
  message.mutable_request()->set_request_id("1");
  message.mutable_request()->mutable_stop_session()->set_rig("floor");
  say(*tab, message);

  const v1::Response& response = connection_.sent.back().response();
  EXPECT_EQ(response.request_id(), "1");
  EXPECT_EQ(response.error().code(), v1::ERROR_CODE_NOT_ALLOWED);
  EXPECT_EQ(response.error().what(), "the centre can only look");
}

TEST_F(LiveTest, Clock_IsThatOfTheClinic_AndUnknownBeforeItsStatus) {
  const auto tab = open();
  EXPECT_EQ(probe(*tab), 0);
  FakeClinic clinic(server_->port());
  ASSERT_TRUE(receives(*tab, "dtsd/status"));

  const std::int64_t before = utc_ns();
  const std::int64_t host_time = probe(*tab);
  constexpr std::int64_t kUtcMinusMonotonic = 5;  // in the clinic's status
  constexpr std::int64_t kLongestDelay = 60'000'000'000;
  EXPECT_GE(host_time, before - kUtcMinusMonotonic);
  EXPECT_LE(host_time, utc_ns() - kUtcMinusMonotonic + kLongestDelay);
}

TEST_F(LiveTest, Clock_IsNeverBehindWhatHasArrived) {
  FakeClinic clinic(server_->port());
  const auto tab = open();
  ASSERT_TRUE(receives(*tab, "dtsd/status"));
  v1::StatusSnapshot status = status_of_kent();
  status.set_host_time_ns(utc_ns() + 3'600'000'000'000);  // the offset in the heartbeat is wrong by an hour
  clinic.publish("dtsd/status", status.SerializeAsString());

  EXPECT_TRUE(runs_until([&] { return probe(*tab) >= status.host_time_ns(); }));
}

TEST_F(LiveTest, Tab_ReceivesWhatItSubscribes) {
  FakeClinic clinic(server_->port());
  const auto tab = open();
  v1::FromBrowser message;
  message.mutable_subscribe()->add_topics("floor/cop");
  say(*tab, message);

  EXPECT_TRUE(receives(*tab, "floor/cop"));
}

TEST_F(LiveTest, ViewEndsWithItsLastTab_AndIsMadeAgain) {
  FakeClinic clinic(server_->port());
  for (int round = 0; round < 3; ++round) {
    connection_.sent.clear();
    const auto first = open();
    FakeConnection other;
    const auto second = live_->open_tab({.user = "bert", .role = v1::ROLE_VIEWER}, "kent", other);
    EXPECT_TRUE(receives(*first, "dtsd/status")) << round;
  }
}

}  // namespace
}  // namespace dts::fleet::desk
