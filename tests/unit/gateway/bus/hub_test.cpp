// SPDX-License-Identifier: Apache-2.0
#include "gateway/bus/hub.h"

#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <utility>

#include "unit/gateway/answered_test.h"
#include "unit/gateway/bus/fake_connection.h"

namespace dts::gateway {
namespace {

constexpr unsigned kPolicyViolation = 1008;

v1::FromBrowser status_request(const std::string& id) {
  v1::FromBrowser message;
  message.mutable_request()->set_request_id(id);
  message.mutable_request()->mutable_status();
  return message;
}

class HubTest : public IoTest {
 protected:
  std::unique_ptr<Tab> open(v1::Role role = v1::ROLE_VIEWER) { return hub_.open_tab({.user = "anna", .role = role}, connection_); }

  void come_up() {
    v1::Link up;
    up.set_is_up(true);
    hub_.handle(up);
  }
  static void subscribe(Tab& tab, const std::vector<std::string>& topics) {
    v1::FromBrowser message;
    for (const std::string& topic : topics) message.mutable_subscribe()->add_topics(topic);
    message.mutable_subscribe();
    say(tab, message);
  }
  void publish(const std::string& topic, Carried::Kind kind, bool is_retained = false, std::uint64_t instance_id = 7) {
    hub_.handle(std::make_shared<Carried>(
        Carried{.topic = topic, .kind = kind, .bytes = "x", .scans = 1, .is_retained = is_retained, .instance_id = instance_id}));
  }
  /// Lets timers run until the tab has got a frame; its topics.
  std::vector<std::string> next_frame() {
    const std::size_t before = connection_.sent.size();
    EXPECT_TRUE(runs_until([&] { return connection_.sent.size() > before; }));
    std::vector<std::string> topics;
    for (const v1::Carried& carried : connection_.sent.back().frame().messages()) topics.push_back(carried.topic());
    return topics;
  }

  FakeConnection connection_;
  CommandPool commands_{io_, "ipc:///nonexistent/control.sock"};
  std::vector<std::vector<std::string>> wishes_;
  Hub hub_{io_, &commands_, [this](std::vector<std::string> wanted) { wishes_.push_back(std::move(wanted)); }, "1.2.3"};
};

TEST_F(HubTest, AStatusThatIsOld_IsNone_ThoughDataGoOnArriving) {
  come_up();
  publish(std::string(kStatusTopic), Carried::Kind::Status, true);
  publish("floor/cop", Carried::Kind::Block);
  const auto now = std::chrono::steady_clock::now();

  EXPECT_NE(hub_.status(now), nullptr);
  EXPECT_EQ(hub_.status(now + std::chrono::seconds(6)), nullptr);
}

TEST_F(HubTest, ATabIsToldFirstWhoItIsAndWhetherTheDaemonIsThere) {
  come_up();
  const auto tab = open(v1::ROLE_OPERATOR);

  ASSERT_EQ(connection_.sent.size(), 1U);
  const v1::Welcome& welcome = connection_.sent[0].welcome();
  EXPECT_EQ(welcome.user(), "anna");
  EXPECT_EQ(welcome.role(), v1::ROLE_OPERATOR);
  EXPECT_EQ(welcome.version(), "1.2.3");
  EXPECT_TRUE(welcome.link().is_up());
}

TEST_F(HubTest, StatesOfAClinicThatIsNotTrusted_AreLimited) {
  for (int number = 0; number < 1000; ++number) publish("r" + std::to_string(number) + "/session", Carried::Kind::Event, true);
  const std::string large(3U << 20U, 'x');
  for (const char* topic : {"a/session", "a/session", "b/session"}) {
    hub_.handle(std::make_shared<Carried>(
        Carried{.topic = topic, .kind = Carried::Kind::Event, .bytes = large, .is_retained = true, .instance_id = 8}));
  }
  publish("c/session", Carried::Kind::Event, true, 8);
  EXPECT_LE(hub_.retained_bytes(), 4U << 20U);
  EXPECT_GT(hub_.retained_bytes(), 3U << 20U);
  for (int number = 0; number < 1000; ++number) publish("r" + std::to_string(number) + "/session", Carried::Kind::Event, true, 9);
  EXPECT_EQ(hub_.retained_bytes(), 256U);  // one byte each
}

TEST_F(HubTest, WhoComesLateIsToldTheLastStatesOfWhatItWants) {
  publish("floor/session", Carried::Kind::Event, true);
  publish("chair/session", Carried::Kind::Event, true);
  publish("dtsd/status", Carried::Kind::Status, true);
  publish("floor/marker", Carried::Kind::Event);
  const auto tab = open();

  subscribe(*tab, {"floor/"});

  EXPECT_EQ(next_frame(), (std::vector<std::string>{"dtsd/status", "floor/session"}));
}

TEST_F(HubTest, StatesOfADaemonThatIsGoneAreToldNobody) {
  publish("dtsd/status", Carried::Kind::Status, true, 7);
  publish("floor/session", Carried::Kind::Event, true, 7);
  publish("floor/device", Carried::Kind::Event, true, 7);

  publish("floor/cop", Carried::Kind::Block, false, 8);
  publish("floor/device", Carried::Kind::Event, true, 8);
  const auto tab = open();
  subscribe(*tab, {"floor/"});

  EXPECT_EQ(next_frame(), std::vector<std::string>{"floor/device"});
}

TEST_F(HubTest, AStateThatWaitsAlreadyIsNotToldTwice) {
  publish("floor/session", Carried::Kind::Event, true);
  const auto tab = open();

  for (int times = 0; times < 300; ++times) subscribe(*tab, {"floor/"});

  EXPECT_EQ(next_frame(), std::vector<std::string>{"floor/session"});
}

TEST_F(HubTest, ManyChangesOfWishesAreToldAFewTimesAndTheLastOneSurely) {
  const auto tab = open();

  for (int times = 0; times < 1000; ++times) subscribe(*tab, {"floor/" + std::to_string(times)});
  const std::size_t at_once = wishes_.size();
  EXPECT_TRUE(runs_until([&] { return wishes_.back() == std::vector<std::string>{"floor/999"}; }));
  EXPECT_LT(at_once, 100U) << "a burst of 20 and 5 a second, however slow this machine is";
  EXPECT_LE(wishes_.size(), at_once + 1);
}

TEST_F(HubTest, TheReaderIsToldWhatAllTabsWantTogetherAndOnlyWhenThatChanges) {
  FakeConnection other_connection;
  auto tab = open();
  auto other = hub_.open_tab({.user = "ben", .role = v1::ROLE_VIEWER}, other_connection);

  subscribe(*tab, {"floor/cop"});
  subscribe(*other, {"floor/cop"});
  subscribe(*other, {"chair/"});
  tab.reset();
  other.reset();

  EXPECT_EQ(wishes_, (std::vector<std::vector<std::string>>{{"floor/cop"}, {"chair/", "floor/cop"}, {"chair/"}, {}}));
}

TEST_F(HubTest, ACommandThatIsNotForItIsRefusedAndGoesNowhere) {
  v1::FromBrowser note = status_request("r1");
  note.mutable_request()->mutable_note_login();
  v1::FromBrowser start = status_request("r1");
  start.mutable_request()->mutable_start_session()->set_rig("floor");
  v1::FromBrowser audit = status_request("r1");
  audit.mutable_request()->mutable_get_audit();
  v1::FromBrowser nothing;
  nothing.mutable_request()->set_request_id("r1");
  std::string umlauts = "a";
  for (int count = 0; count < 40; ++count) umlauts += "\u00e4";  // two bytes each: byte 64 is the first half of one
  const std::string unknown = "unknown command for this version of the gateway; reload the page";
  for (const auto& [message, role, id, says] :
       {std::tuple(start, v1::ROLE_VIEWER, std::string("r1"),
                   std::string("this command requires the role operator; log in as a user with this role")),
        {audit, v1::ROLE_OPERATOR, "r1", "this command requires the role engineer; log in as a user with this role"},
        {note, v1::ROLE_ENGINEER, "r1", unknown},
        {nothing, v1::ROLE_ENGINEER, "r1", unknown},
        {status_request(""), v1::ROLE_ENGINEER, "", unknown},
        {status_request(std::string(65, 'x')), v1::ROLE_ENGINEER, std::string(64, 'x'), unknown},
        {status_request(umlauts), v1::ROLE_ENGINEER, umlauts.substr(0, 63), unknown}}) {
    const auto tab = open(role);
    connection_.sent.clear();

    say(*tab, message);

    ASSERT_EQ(connection_.sent.size(), 1U);
    const v1::Response& response = connection_.sent[0].response();
    EXPECT_EQ(response.request_id(), id);
    EXPECT_EQ(response.error().code(), says == unknown ? v1::ERROR_CODE_INVALID_ARGUMENT : v1::ERROR_CODE_NOT_ALLOWED);
    EXPECT_EQ(response.error().what() + "; " + response.error().hint(), says);
  }
}

TEST_F(HubTest, TheNinthCommandAtOnceIsRefused) {
  const auto tab = open();
  connection_.sent.clear();
  for (int count = 1; count <= 9; ++count) say(*tab, status_request("r" + std::to_string(count)));

  ASSERT_EQ(connection_.sent.size(), 1U);
  EXPECT_EQ(connection_.sent[0].response().request_id(), "r9");
  EXPECT_EQ(connection_.sent[0].response().error().code(), v1::ERROR_CODE_LIMIT_EXCEEDED);
  EXPECT_EQ(connection_.sent[0].response().error().what(), "too many commands at once");
}

TEST_F(HubTest, WhatIsNoMessageOfTheProtocolEndsTheConnection) {
  v1::FromBrowser unsent_frame;
  unsent_frame.mutable_painted()->set_frame(7);
  v1::FromBrowser mad_rate;
  mad_rate.mutable_subscribe()->set_frames_per_second(1e9);
  for (const auto& [bytes, reason] : {std::pair(std::string("\xff\xff\xff"), "not a message of dts.v1"),
                                      {"", "an empty message"},
                                      {unsent_frame.SerializeAsString(), "confirmed a frame that was not sent"},
                                      {mad_rate.SerializeAsString(), "too many or too long topics, or an impossible rate"}}) {
    const auto tab = open();
    connection_.closed_with.reset();

    tab->on_message(bytes);

    EXPECT_EQ(connection_.closed_with, kPolicyViolation) << reason;
    EXPECT_EQ(connection_.close_reason, reason);
  }
}

TEST_F(HubTest, ACommandThatIsAllowedReachesForTheDaemon) {
  const auto tab = open(v1::ROLE_OPERATOR);
  say(*tab, status_request("r1"));
  io_.run_one_for(testing::kDeadline);

  ASSERT_EQ(connection_.sent.size(), 2U);
  EXPECT_EQ(connection_.sent[1].response().error().code(), v1::ERROR_CODE_UNREACHABLE);
}

TEST_F(HubTest, ATabWhoseLoginHasEndedIsClosedByTheNextCommandOrStatus) {
  bool is_logged_in = true;
  const auto tab = hub_.open_tab({.user = "anna", .role = v1::ROLE_VIEWER, .holds = [&] { return is_logged_in; }}, connection_);
  publish("dtsd/status", Carried::Kind::Status);
  EXPECT_FALSE(connection_.closed_with);

  is_logged_in = false;

  publish("dtsd/status", Carried::Kind::Status);
  EXPECT_EQ(std::exchange(connection_.closed_with, std::nullopt), 4401U);
  say(*tab, status_request("r1"));
  EXPECT_EQ(connection_.closed_with, 4401U);
  EXPECT_EQ(connection_.close_reason, "the login has expired");
}

TEST_F(HubTest, AnAnswerForATabThatIsGoneIsForgotten) {
  auto tab = open(v1::ROLE_OPERATOR);
  say(*tab, status_request("r1"));

  tab.reset();
  io_.run_one_for(testing::kDeadline);

  EXPECT_EQ(connection_.sent.size(), 1U);
}

TEST_F(HubTest, AClockProbeIsAnsweredAtOnceWithBothTimes) {
  const auto tab = open();
  v1::FromBrowser message;
  message.mutable_clock_probe()->set_browser_ms(12.5);
  const auto before = std::chrono::steady_clock::now().time_since_epoch();

  say(*tab, message);

  const v1::ClockAnswer& answer = connection_.sent.back().clock_answer();
  EXPECT_EQ(answer.browser_ms(), 12.5);
  EXPECT_GE(answer.host_time_ns(), std::chrono::nanoseconds(before).count());
}

TEST_F(HubTest, ASlowNetworkGetsNothingUntilItHasTakenWhatIsUnderWay) {
  const auto tab = open();
  subscribe(*tab, {"floor/"});
  connection_.unsent = 10U << 20U;
  publish("floor/cop", Carried::Kind::Block);
  io_.run_for(std::chrono::milliseconds(120));
  EXPECT_EQ(connection_.sent.size(), 1U);

  connection_.unsent = 0;

  EXPECT_EQ(next_frame(), std::vector<std::string>{"floor/cop"});
}

}  // namespace
}  // namespace dts::gateway
