// SPDX-License-Identifier: Apache-2.0
// Upload and facts over a real nats-server, with a hub in memory behind it.
#include "fleet/forward/uplink.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "fleet/forward/desk.h"
#include "fleet/forward/outbox.h"
#include "fleet/forward/uploader.h"
#include "support/nats_server.h"
#include "support/temporary_folder.h"
#include "unit/fleet/forward/fake_centre.h"
#include "unit/fleet/forward/fake_clinic.h"
#include "unit/fleet/forward/recording_file.h"

namespace dts::fleet::forward {
namespace {

class UplinkTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::NatsServer::program()) GTEST_SKIP() << "nats-server is not installed";
    server_.emplace();
    uplink_ = open("kent");
    wait_until([this] { return uplink_->is_connected(); });
  }
  [[nodiscard]] link::LinkOptions options(const std::string& name) const {
    return {.servers = {"nats://127.0.0.1:" + std::to_string(server_->port())}, .name = name, .inbox_prefix = "_INBOX.kent"};
  }
  [[nodiscard]] std::unique_ptr<Uplink> open(const std::string& name) const { return open_uplink(options(name), core::Log()).value(); }
  static void wait_until(const std::function<bool()>& is_so) {
    while (!is_so()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  /// A hub that answers as FakeCentre does, until the test ends.
  void start_hub() {
    auto link = std::shared_ptr<link::Link>(link::Link::open(options("hub"), core::Log()).value());
    wait_until([&link] { return link->is_connected(); });
    auto letters = std::shared_ptr<link::Subscription>(link->subscribe("dts.v1.>").value());
    hub_ = std::jthread([this, link, letters](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        const auto letter = letters->next(std::chrono::milliseconds(20));
        if (!letter) continue;
        const std::lock_guard lock(mutex_);
        (void)centre_.publish(*letter);
        const auto answer = centre_.listen(letter->reply).value()->next(std::chrono::milliseconds(0));
        if (answer) (void)link->publish({.subject = letter->reply, .data = answer->data});
      }
    });
    wait_until([this] { return ask(*uplink_, "dts.v1.kent.erase", erase("x"), std::chrono::milliseconds(200), {}).has_value(); });
  }
  static std::string erase(const std::string& session) {
    v1::EraseSession request;
    request.set_session_id(session);
    return request.SerializeAsString();
  }

  std::optional<test::NatsServer> server_;
  std::unique_ptr<Uplink> uplink_;
  std::mutex mutex_;
  FakeCentre centre_;  ///< Behind the mutex.
  std::jthread hub_;
};

TEST_F(UplinkTest, Ask_ReturnsTheAnswer) {
  start_hub();
  const auto answer = ask(*uplink_, "dts.v1.kent.erase", erase("s-1"), std::chrono::milliseconds(20'000), {});
  ASSERT_TRUE(answer) << core::to_string(answer.error());
  EXPECT_EQ(wire::decode_erase_answer(*answer).value().files(), 1U);
}

TEST_F(UplinkTest, AskWithoutAHub_FailsAtOnce) {
  const auto answer = ask(*uplink_, "dts.v1.kent.erase", "x", std::chrono::hours(1), {});
  EXPECT_EQ(answer.error().code, core::ErrorCode::Unreachable);
  EXPECT_EQ(answer.error().what, "no hub runs at the centre");
}

TEST_F(UplinkTest, AskOfASilentHub_FailsWithTimeout) {
  const auto silent = link::Link::open(options("hub"), core::Log()).value();
  const auto letters = silent->subscribe("dts.v1.>").value();
  wait_until([&] { return uplink_->publish({.subject = "dts.v1.kent.beat"}) && letters->next(std::chrono::milliseconds(10)); });
  EXPECT_EQ(ask(*uplink_, "dts.v1.kent.erase", "x", std::chrono::milliseconds(50), {}).error().code, core::ErrorCode::Timeout);
}

TEST_F(UplinkTest, AskThatIsStopped_EndsBeforeItsTimeout) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(ask(*uplink_, "dts.v1.kent.erase", "x", std::chrono::hours(1), stop.get_token()).error().code, core::ErrorCode::Failed);
}

TEST_F(UplinkTest, AskWithoutAConnection_FailsAtOnce) {
  server_->kill();
  wait_until([this] { return !uplink_->is_connected(); });
  EXPECT_EQ(ask(*uplink_, "dts.v1.kent.erase", "x", std::chrono::hours(1), {}).error().code, core::ErrorCode::Unreachable);
}

TEST_F(UplinkTest, ServerThatIsKilledInBetween_RecordingArrivesOnce) {
  RecordProperty("requirement", "FLEET-1");
  start_hub();
  test::TemporaryFolder folder;
  FakeClinic clinic;
  const auto store = Store::open(folder.path()).value();
  core::SystemClock clock;
  const auto closed = write_recording(folder.path() + "/a.xdf", "a", 120);
  clinic.add_part(clinic.add("a", 1), closed.file, closed.sha256, closed.bytes);
  Outbox outbox(clinic, *store, {}, core::Log());
  ASSERT_TRUE(outbox.look_at_all(1'000'000'000, {}));
  Desk desk("kent", *uplink_, *store, core::Log());
  Uploader uploader({.clinic = "kent", .rules = {}, .limits = {}}, *uplink_, *store, clock, core::Log());
  {
    const std::lock_guard lock(mutex_);
    centre_.lose = [this, chunks = 0](const wire::Subject& subject) mutable {
      if (subject.matter == wire::Matter::Chunk && ++chunks == 12) server_->start();  // kills it first
      return false;
    };
  }
  while (store->backlog().value().files() > 0) {
    desk.serve(std::chrono::steady_clock::now(), {});
    if (!uploader.work({})) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  const std::lock_guard lock(mutex_);
  ASSERT_EQ(centre_.stored.size(), 1U);
  EXPECT_EQ(centre_.stored.begin()->first, record::sha256_of(centre_.stored.begin()->second));
  EXPECT_EQ(centre_.stored.begin()->second.size(), closed.bytes);
  EXPECT_GE(uplink_->connections(), 2U);
}

}  // namespace
}  // namespace dts::fleet::forward
