// SPDX-License-Identifier: Apache-2.0
#include "ipc/publish_thread.h"

#include <gtest/gtest.h>
#include <poll.h>

#include <algorithm>
#include <functional>
#include <string>
#include <thread>
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
    for (const core::StreamFormat& format : rig_->formats()) frame_.streams.emplace_back(format.channels.size(), config.block_scans);
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
  void post_session(const std::string& label) {
    v1::Event event;
    event.mutable_session()->set_label(label);
    publisher_->post("floor", std::move(event));
  }
  void post_marker(const std::string& text) {
    v1::Event event;
    event.mutable_marker()->set_text(text);
    publisher_->post("floor", std::move(event));
  }
  /// Writes a frame with its events, as the rig's thread would; that thread does not run.
  void push(const std::function<void(core::Frame&)>& fill, const core::FrameEvents& events = {}) {
    for (core::Block& block : frame_.streams) block.set_count(0);
    frame_.gap_before = {};
    fill(frame_);
    rig_->frames().write(frame_, events);
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
  core::Frame frame_;
  TurnSocket* socket_ = nullptr;
  std::unique_ptr<PublishThread> publisher_;
};

TEST_F(PublishTest, Frame_LeavesGapFirst_ThenTriggersBlocksAndWhatWasFoundInThem) {
  using enum core::ReachStep;
  core::FrameEvents events;
  events.triggers.push({});
  events.reaches.push({});
  events.sways.push({});
  push(
      [&](core::Frame& frame) {
        frame.gap_before.reason = core::GapReason::Silence;
        for (const char* name : {"raw", "cop", "deflection"}) frame.streams[stream(name)].set_count(1);
      },
      events);
  EXPECT_EQ(socket_->turn(), "floor/gap floor/trigger floor/raw floor/cop floor/reach floor/sway ") << "deflection is not published";
  push([](core::Frame&) {});
  EXPECT_EQ(socket_->turn(), "") << "a block without scans says nothing";
}

TEST_F(PublishTest, FramesWithoutEvents_ArePublishedOnTheRigsThread) {
  static_cast<void>(socket_->turn());
  const std::uint64_t turns = publisher_->turns();
  const auto is_published = [&] { return std::ranges::any_of(rig_->published().latency.blocks, [](auto blocks) { return blocks > 0; }); };
  rig_->start(core::Log());
  while (!is_published()) std::this_thread::yield();
  rig_->stop();

  EXPECT_TRUE(socket_->sent_.starts_with("floor/raw ")) << socket_->sent_.substr(0, 40);
  EXPECT_EQ(publisher_->turns(), turns);
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

  EXPECT_DOUBLE_EQ(rig_->published().latency.sum_ms, 8.0);
  const std::uint64_t turns = publisher_->turns();
  static_cast<void>(socket_->turn());
  EXPECT_EQ(publisher_->turns(), turns + 1) << "by which the watchdog sees that the thread lives";
}

TEST_F(PublishTest, RetainedMessages_AreRepeatedForANewSubscriber_OncePerTenthOfASecond) {
  RecordProperty("requirement", "PUB-5");
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
