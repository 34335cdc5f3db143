// SPDX-License-Identifier: Apache-2.0
// With a real nats-server and a clinic of this test.
#include "fleet/desk/watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <variant>
#include <vector>

#include "fleet/wire/messages.h"
#include "support/nats_server.h"
#include "unit/fleet/desk/fake_clinic.h"

namespace dts::fleet::desk {
namespace {

using namespace std::chrono_literals;
using gateway::Carried;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(CarriedOf, KnowsTheKindByTheTopic) {
  v1::Event event;
  event.set_instance_id(7);
  event.mutable_session()->set_session_id("S");
  v1::Event marker;
  marker.mutable_marker()->set_text("x");

  const auto status = carried_of("dtsd/status", status_of_kent().SerializeAsString());
  const auto session = carried_of("floor/session", event.SerializeAsString());
  const auto block = carried_of("floor/cop", block_of_cop().SerializeAsString());
  ASSERT_TRUE(status && session && block);
  EXPECT_EQ(status->kind, Carried::Kind::Status);
  EXPECT_TRUE(status->is_retained);
  EXPECT_EQ(session->kind, Carried::Kind::Event);
  EXPECT_TRUE(session->is_retained);
  EXPECT_FALSE(carried_of("floor/marker", marker.SerializeAsString())->is_retained);
  EXPECT_EQ(block->kind, Carried::Kind::Block);
  EXPECT_EQ(block->scans, 4U);
  EXPECT_EQ(block->instance_id, 7U);
}

TEST(CarriedOf, OtherBytes_AreNothing) {
  for (const char* topic : {"dtsd/status", "floor/session", "floor/cop"}) EXPECT_EQ(carried_of(topic, "\x0a\xff"), nullptr) << topic;
  EXPECT_EQ(carried_of("floor/cop", std::string(wire::kLargestMessage + 1, '\0')), nullptr);
}

TEST(TopicsOf, StatusAndRetainedEventsAlways_OthersByPrefix) {
  const auto status = status_of_kent();

  EXPECT_THAT(topics_of(nullptr, {"floor/cop"}), ElementsAre("dtsd/status"));
  EXPECT_THAT(topics_of(&status, {}), ElementsAre("dtsd/status", "floor/device", "floor/session"));
  EXPECT_THAT(topics_of(&status, {"floor/cop", "floor/tr", "chair/"}),
              ElementsAre("dtsd/status", "floor/cop", "floor/device", "floor/session", "floor/trial", "floor/trigger"));
  EXPECT_THAT(topics_of(&status, {""}), Contains("floor/raw"));
}

TEST(ProblemOfStatus, RigsAndStreamsAreLimited) {
  auto status = status_of_kent();
  EXPECT_EQ(problem_of_status(status), "");
  for (int stream = 0; stream <= kMostStreams; ++stream) status.mutable_rigs(0)->mutable_rig()->add_published("s");
  EXPECT_EQ(problem_of_status(status), "the clinic reports more than 64 streams of a rig");
  status.clear_rigs();
  for (int rig = 0; rig < kMostRigs; ++rig) status.add_rigs();
  EXPECT_EQ(problem_of_status(status), "");
  status.add_rigs();
  EXPECT_EQ(problem_of_status(status), "the clinic reports more than 64 rigs");
}

TEST(TopicsOf, StatusOfAHostileClinic_IsLimited) {
  v1::StatusSnapshot status;
  for (int rig = 0; rig < 500; ++rig) status.add_rigs()->mutable_rig()->set_name("r" + std::to_string(rig));

  EXPECT_EQ(topics_of(&status, {""}).size(), kMostTopics);
}

class WatchTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::NatsServer::program()) GTEST_SKIP() << "nats-server is not installed";
    server_.emplace();
    auto opened = link::Link::open(
        {.servers = {"nats://127.0.0.1:" + std::to_string(server_->port())}, .name = "desk", .inbox_prefix = "_DASHBOARD.x"}, core::Log());
    ASSERT_TRUE(opened);
    link_ = std::move(*opened);
  }
  std::unique_ptr<Watch> watch(const std::set<std::string>& viewers = {"anna"}) {
    auto made = std::make_unique<Watch>(*link_, "kent", [this](gateway::BusItem item) {
      const std::lock_guard lock(mutex_);
      items_.push_back(std::move(item));
      changed_.notify_all();
    });
    made->set_viewers(viewers);
    return made;
  }
  /// Waits until `condition` holds for what has arrived.
  bool becomes(const std::function<bool(const std::vector<gateway::BusItem>&)>& condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, 60s, [&] { return condition(items_); });
  }
  bool has_problem(const std::string& text) {
    return becomes([&](const auto& items) {
      return std::ranges::any_of(items, [&](const gateway::BusItem& item) {
        const auto* link = std::get_if<v1::Link>(&item);
        return link != nullptr && !link->is_up() && link->problem().find(text) != std::string::npos;
      });
    });
  }
  static bool has_topic(const std::vector<gateway::BusItem>& items, const std::string& topic) {
    return std::ranges::any_of(items, [&](const gateway::BusItem& item) {
      const auto* message = std::get_if<gateway::CarriedPointer>(&item);
      return message != nullptr && (*message)->topic == topic;
    });
  }

  std::optional<test::NatsServer> server_{};
  std::unique_ptr<link::Link> link_{};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<gateway::BusItem> items_{};
};

TEST_F(WatchTest, WantedTopics_ArriveAfterTheLinkIsUp) {
  FakeClinic clinic(server_->port());
  const auto watched = watch();
  watched->want({"floor/cop"});

  ASSERT_TRUE(becomes([](const auto& items) { return has_topic(items, "floor/cop"); }));
  const std::lock_guard lock(mutex_);
  const auto up = std::ranges::find_if(
      items_, [](const auto& item) { return std::holds_alternative<v1::Link>(item) && std::get<v1::Link>(item).is_up(); });
  const auto status = std::ranges::find_if(items_, [](const auto& item) { return std::holds_alternative<gateway::CarriedPointer>(item); });
  EXPECT_LT(up - items_.begin(), status - items_.begin());
  EXPECT_EQ(std::get<gateway::CarriedPointer>(*status)->topic, "dtsd/status");
  EXPECT_TRUE(watched->delay().has_value());
}

TEST_F(WatchTest, TheClinicSeesWhoWatchesWhat) {
  FakeClinic clinic(server_->port());
  const auto watched = watch({"anna", "bert"});
  ASSERT_TRUE(becomes([](const auto& items) { return has_topic(items, "dtsd/status"); }));
  watched->want({"floor/cop"});
  ASSERT_TRUE(becomes([](const auto& items) { return has_topic(items, "floor/cop"); }));

  std::set<std::string> names;
  for (const v1::LiveRequest& request : clinic.requests()) names.insert(request.who());
  EXPECT_THAT(names, ElementsAre("anna", "bert"));
  EXPECT_THAT(clinic.requests().front().topics(), Not(Contains("floor/cop")));
  EXPECT_THAT(clinic.requests().back().topics(), ElementsAre("dtsd/status", "floor/cop", "floor/device", "floor/session"));
}

TEST_F(WatchTest, LettersThatAreNoMessages_AreDropped) {
  FakeClinic clinic(server_->port());
  const auto watched = watch();
  watched->want({"floor/cop", "floor/raw"});
  ASSERT_TRUE(becomes([](const auto& items) { return has_topic(items, "floor/cop"); }));  // so both were asked for
  clinic.publish("floor/raw", "\x0a\xff");
  clinic.publish("floor/session", "");

  ASSERT_TRUE(becomes([](const auto& items) { return has_topic(items, "floor/session"); }));
  const std::lock_guard lock(mutex_);
  EXPECT_FALSE(has_topic(items_, "floor/raw"));
}

TEST_F(WatchTest, TopicsThatNobodyAskedFor_AreDropped) {
  FakeClinic clinic(server_->port());
  const auto watched = watch();
  watched->want({"floor/cop"});
  ASSERT_TRUE(becomes([](const auto& items) { return has_topic(items, "floor/cop"); }));
  for (const char* topic : {"floor/raw", "other/cop", "other/session"}) clinic.publish(topic, block_of_cop().SerializeAsString());
  clinic.publish("floor/session", "");

  ASSERT_TRUE(becomes([](const auto& items) { return has_topic(items, "floor/session"); }));
  const std::lock_guard lock(mutex_);
  for (const char* topic : {"floor/raw", "other/cop", "other/session"}) EXPECT_FALSE(has_topic(items_, topic)) << topic;
}

TEST_F(WatchTest, StatusWithTooManyRigs_IsNotPassedOn_AndNamed) {
  FakeClinic clinic(server_->port());
  const auto watched = watch();
  ASSERT_TRUE(becomes([](const auto& items) { return has_topic(items, "dtsd/status"); }));
  v1::StatusSnapshot status;
  for (int rig = 0; rig < 10'000; ++rig) status.add_rigs()->mutable_rig()->set_name("r" + std::to_string(rig));
  clinic.publish("dtsd/status", status.SerializeAsString());

  ASSERT_TRUE(has_problem("the clinic reports more than 64 rigs"));
  const std::lock_guard lock(mutex_);
  for (const auto& item : items_) {
    const auto* message = std::get_if<gateway::CarriedPointer>(&item);
    EXPECT_LT(message == nullptr ? 0U : (*message)->bytes.size(), 1000U);
  }
}

TEST_F(WatchTest, EachStatusWithTooManyRigs_IsNamed_AlsoIfASoundOneIsReadWithIt) {
  constexpr int kPairs = 20;
  FakeClinic clinic(server_->port());
  const auto watched = watch();
  ASSERT_TRUE(becomes([](const auto& items) { return has_topic(items, "dtsd/status"); }));
  v1::StatusSnapshot status;
  for (int rig = 0; rig <= kMostRigs; ++rig) status.add_rigs();
  for (int pair = 0; pair < kPairs; ++pair) {
    clinic.publish("dtsd/status", status.SerializeAsString());
    clinic.publish("dtsd/status", status_of_kent().SerializeAsString());
  }

  EXPECT_TRUE(becomes([](const auto& items) {
    return std::ranges::count_if(items, [](const gateway::BusItem& item) {
             const auto* link = std::get_if<v1::Link>(&item);
             return link != nullptr && link->problem() == "the clinic reports more than 64 rigs";
           }) == kPairs;
  }));
}

TEST_F(WatchTest, Refusal_IsReportedInTheWordsOfTheClinic) {
  FakeClinic clinic(server_->port(), "the clinic does not allow it");
  const auto watched = watch();

  EXPECT_TRUE(has_problem("the clinic does not allow it"));
}

TEST_F(WatchTest, ClinicThatIsAway_IsReported_AndSeenWhenItReturns) {
  const auto watched = watch();
  ASSERT_TRUE(has_problem("the clinic is not connected to the centre"));
  FakeClinic clinic(server_->port());

  EXPECT_TRUE(becomes([](const auto& items) { return has_topic(items, "dtsd/status"); }));
}

TEST_F(WatchTest, ServerThatIsGone_IsReported_AndTheWatchGoesOnAfterIt) {
  FakeClinic clinic(server_->port());
  const auto watched = watch();
  ASSERT_TRUE(becomes([](const auto& items) { return has_topic(items, "dtsd/status"); }));
  server_->kill();
  ASSERT_TRUE(has_problem("nats-server"));
  {
    const std::lock_guard lock(mutex_);
    items_.clear();
  }
  server_->start();

  EXPECT_TRUE(becomes([](const auto& items) { return has_topic(items, "dtsd/status"); }));
}

}  // namespace
}  // namespace dts::fleet::desk
