// SPDX-License-Identifier: Apache-2.0
#include "ipc/publish_thread.h"

#include <gtest/gtest.h>
#include <poll.h>

#include <functional>
#include <string>
#include <vector>

#include "dts/v1/control.pb.h"
#include "unit/ipc/turn_socket.h"
#include "unit/session/floor_config.h"

namespace dts::ipc {
namespace {

class PublishTest : public ::testing::Test {
 protected:
  PublishTest() {
    pipeline::RigConfig config = session::floor_config("sim:floor?seed=3");
    config.trigger.emplace().channel = 4;
    rig_ = session::Rig::create(config, clock_, bell_).value();
    auto socket = std::make_unique<TurnSocket>();
    socket_ = socket.get();
    publisher_ = std::make_unique<PublishThread>(std::move(socket), bell_, std::vector{rig_.get()}, clock_, 7);
    static_cast<void>(publisher_->start({}));
  }
  ~PublishTest() override {
    socket_->end();
    publisher_->stop();
  }
  void post_status(const std::string& version) {
    v1::StatusSnapshot status;
    status.set_version(version);
    publisher_->post(std::move(status));
  }
  /// A session event is retained, a marker is not.
  void post_session(const std::string& id) {
    v1::Event event;
    event.mutable_session()->set_session_id(id);
    publisher_->post("floor", std::move(event));
  }
  void post_marker(const std::string& text) {
    v1::Event event;
    event.mutable_marker()->set_text(text);
    publisher_->post("floor", std::move(event));
  }
  /// Hands a frame to the publisher; the rig's own threads do not run.
  void push(const std::function<void(core::Frame&)>& fill) {
    core::Frame* frame = rig_->frames().claim();
    ASSERT_NE(frame, nullptr);
    for (core::Block& block : frame->streams) block.set_count(0);
    frame->events.clear();
    frame->gap_before = {};
    fill(*frame);
    rig_->frames().commit();
  }
  [[nodiscard]] bool is_bell_rung() const {
    pollfd bell{.fd = bell_.fd(), .events = POLLIN, .revents = 0};
    return ::poll(&bell, 1, 0) == 1;
  }
  [[nodiscard]] std::size_t stream(const std::string& name) const {
    std::size_t index = 0;
    while (rig_->formats()[index].name != name) ++index;
    return index;
  }

  core::VirtualClock clock_{1'000'000'000};
  core::Doorbell bell_;
  std::unique_ptr<session::Rig> rig_;
  TurnSocket* socket_ = nullptr;
  std::unique_ptr<PublishThread> publisher_;
};

TEST_F(PublishTest, Frame_LeavesGapFirst_ThenTriggersBlocksAndWhatWasFoundInThem) {
  using enum core::ReachStep;
  push([&](core::Frame& frame) {
    frame.gap_before.reason = core::GapReason::Silence;
    frame.events.triggers.push({});
    for (const char* name : {"raw", "cop", "deflection"}) frame.streams[stream(name)].set_count(1);
    frame.events.sways.push({});
  });
  EXPECT_EQ(socket_->turn(), "floor/gap floor/trigger floor/raw floor/cop floor/sway ") << "deflection is not published";
  push([](core::Frame&) {});
  EXPECT_EQ(socket_->turn(), "") << "a block without scans says nothing";
}

TEST_F(PublishTest, Class_LeavesRightAfterTheFinalStepOfItsReach) {
  const auto reach = [](core::ReachStep step, std::uint32_t number, std::uint64_t scan) {
    return core::ReachEvent{.step = step, .number = number, .scan = {scan}};
  };
  using enum core::ReachStep;
  const struct {
    std::vector<core::ReachEvent> reaches;
    std::vector<std::pair<std::uint32_t, std::uint64_t>> classes;  // number, scan
    std::string order;                                             // r: reach, c: class
  } rows[]{
      {{reach(P1, 1, 5), reach(Final, 1, 9)}, {{1, 9}}, "rrc"},  {{reach(Final, 1, 9), reach(P1, 2, 9), reach(P2, 2, 9)}, {{1, 9}}, "rcrr"},
      {{reach(P3, 1, 9), reach(Final, 1, 9)}, {{1, 9}}, "rrc"},  {{reach(Final, 2, 9)}, {{1, 8}, {2, 9}, {3, 10}}, "crcc"},
      {{reach(Final, 1, 9), reach(P1, 2, 10)}, {{3, 9}}, "rcr"}, {{}, {{1, 3}}, "c"},
  };
  for (const auto& row : rows) {
    push([&](core::Frame& frame) {
      for (const core::ReachEvent& event : row.reaches) frame.events.reaches.push(event);
      for (const auto& [number, scan] : row.classes) frame.events.classes.push({.number = number, .scan = {scan}});
    });
    std::string expected;
    for (const char kind : row.order) expected += kind == 'r' ? "floor/reach " : "floor/class ";
    EXPECT_EQ(socket_->turn(), expected) << row.order;
  }
}

TEST_F(PublishTest, ManyFrames_LeaveTurnsToTheOthers) {
  for (int frame = 0; frame < 65; ++frame) push([](core::Frame& out) { out.streams.front().set_count(1); });
  post_status("1");
  std::string all;
  for (int frame = 0; frame < 64; ++frame) all += "floor/raw ";

  EXPECT_EQ(socket_->turn(), all + "dtsd/status=1 ");
  EXPECT_TRUE(is_bell_rung()) << "more is waiting";
  EXPECT_EQ(socket_->turn(), "floor/raw ");
  EXPECT_FALSE(is_bell_rung());
}

TEST_F(PublishTest, Latency_IsThatOfTheNewestScanOfEachRawBlock) {
  for (const std::size_t scans : {4U, 0U}) {
    push([&](core::Frame& frame) {
      frame.streams.front().host_time_ns = 990'000'000;  // the fourth scan was taken 2 ms later, 8 ms ago
      frame.streams.front().set_count(scans);
    });
  }
  static_cast<void>(socket_->turn());

  EXPECT_DOUBLE_EQ(rig_->latency().sum_ms, 8.0);
  const std::uint64_t turns = publisher_->turns();
  static_cast<void>(socket_->turn());
  EXPECT_EQ(publisher_->turns(), turns + 1) << "by which the watchdog sees that the thread lives";
}

TEST_F(PublishTest, RetainedMessages_AreRepeatedForANewSubscriber_OncePerTenthOfASecond) {
  post_status("1");
  post_session("a");
  post_marker("x");
  post_status("2");
  const std::string retained = "dtsd/status=2 floor/session=a ";
  EXPECT_EQ(socket_->turn(), "dtsd/status=1 floor/session=a floor/marker=x dtsd/status=2 ");
  EXPECT_EQ(socket_->timeout_ms_, 200);

  EXPECT_EQ(socket_->turn(true), retained);
  EXPECT_EQ(socket_->turn(), "");
  clock_.advance_ns(99'999'999);
  EXPECT_EQ(socket_->turn(true), "") << "a flood of subscriptions gets no more";
  EXPECT_EQ(socket_->timeout_ms_, 100) << "it is due";
  clock_.advance_ns(1);
  EXPECT_EQ(socket_->turn(), retained);
  EXPECT_EQ(socket_->turn(), "");
}

TEST_F(PublishTest, Outbox_DropsTheOldestThatIsNotRetained_ThenTheOldest) {
  post_status("1");
  for (int message = 0; message < 1000; ++message) post_marker(std::to_string(message));
  const std::string sent = socket_->turn();
  EXPECT_TRUE(sent.starts_with("dtsd/status=1 floor/marker=1 ")) << sent.substr(0, 40);
  EXPECT_TRUE(sent.ends_with("floor/marker=999 "));
  for (int message = 0; message < 1001; ++message) post_status(std::to_string(message));
  EXPECT_TRUE(socket_->turn().starts_with("dtsd/status=1 dtsd/status=2 "));
}

TEST_F(PublishTest, RemotePeers_AreDroppedOncePerOrder) {
  for (const bool can : {false, true}) {
    socket_->can_drop_ = can;
    socket_->drops_ = 0;
    publisher_->drop_remote_peers();
    static_cast<void>(socket_->turn());
    static_cast<void>(socket_->turn());
    EXPECT_EQ(socket_->drops_, 1);
    EXPECT_EQ(publisher_->is_remote_down(), !can);
  }
}

TEST_F(PublishTest, Stop_SendsWhatIsLeft) {
  static_cast<void>(socket_->turn());
  push([](core::Frame& frame) { frame.streams.front().set_count(1); });
  post_session("end");
  socket_->sent_.clear();
  socket_->end();
  publisher_->stop();

  EXPECT_EQ(socket_->sent_, "floor/raw floor/session=end ");
}

}  // namespace
}  // namespace dts::ipc
