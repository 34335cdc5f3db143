// SPDX-License-Identifier: Apache-2.0
// What the status says of losses, queues and latency, and where the publish thread gets the latency from.
#include <gtest/gtest.h>
#include <poll.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <map>
#include <mutex>
#include <thread>

#include "ipc/encode.h"
#include "ipc/publish_thread.h"
#include "unit/session/floor_config.h"

namespace dts::ipc {
namespace {

TEST(LatencyHistogram, BucketsAddUpToAnInfiniteOne) {
  session::LatencyReport report;
  report.add(0.4);
  report.add(3.0);
  report.add(4.0);
  report.add(5000.0);

  const dts::v1::LatencyHistogram histogram = latency_histogram(report);

  ASSERT_EQ(histogram.buckets_size(), 14);
  EXPECT_EQ(histogram.buckets(1).blocks_total(), 0U);
  EXPECT_EQ(histogram.buckets(2).upper_ms(), 0.5);
  EXPECT_EQ(histogram.buckets(2).blocks_total(), 1U);
  EXPECT_EQ(histogram.buckets(5).upper_ms(), 5.0);
  EXPECT_EQ(histogram.buckets(5).blocks_total(), 3U);
  EXPECT_EQ(histogram.buckets(12).blocks_total(), 3U);
  EXPECT_TRUE(std::isinf(histogram.buckets(13).upper_ms()));
  EXPECT_EQ(histogram.buckets(13).blocks_total(), 4U);
  EXPECT_DOUBLE_EQ(histogram.sum_ms(), 5007.4);
}

class HealthTest : public ::testing::Test {
 protected:
  core::SystemClock clock_;
  core::Doorbell bell_;
  std::unique_ptr<session::Rig> rig_ = session::Rig::create(session::floor_config("sim:floor?seed=3"), clock_, bell_).value();
};

TEST_F(HealthTest, SensorProblems_StandWhereTheDeviceItselfHasNone) {
  session::RigState state{.rig = *rig_};
  state.acquisition.device = device::DeviceState::Streaming;
  state.sensor_problems = "sensor ch3 stands still";
  EXPECT_EQ(status_snapshot({}, core::VirtualClock(), {state}, {}).rigs(0).device_message(), "sensor ch3 stands still");

  state.acquisition.set_message("the device fell silent");
  EXPECT_EQ(status_snapshot({}, core::VirtualClock(), {state}, {}).rigs(0).device_message(), "the device fell silent");
}

TEST_F(HealthTest, Status_NamesCausesThatHappenedAndSaysTheRest) {
  session::RigState state{.rig = *rig_, .ring_fill = {.scans_percent = 1.5, .frames_percent = 25.0, .record_percent = 50.0}};
  state.acquisition.losses.add(core::GapReason::Silence, {.gaps = 2, .scans = 40});
  state.recording = {.is_recording = true, .lag_s = 0.5};
  state.latency.add(3.0);

  const dts::v1::StatusSnapshot snapshot = status_snapshot({}, core::VirtualClock(), {state}, {});

  const dts::v1::RigStatus& rig = snapshot.rigs(0);
  ASSERT_EQ(rig.losses_size(), 1);
  EXPECT_EQ(rig.losses(0).reason(), dts::v1::GAP_REASON_SILENCE);
  EXPECT_EQ(rig.losses(0).gaps_total(), 2U);
  EXPECT_EQ(rig.losses(0).lost_scans_total(), 40U);
  EXPECT_EQ(rig.ring_fill().scans_percent(), 1.5);
  EXPECT_EQ(rig.ring_fill().frames_percent(), 25.0);
  EXPECT_EQ(rig.ring_fill().record_percent(), 50.0);
  EXPECT_EQ(rig.record_lag_s(), 0.5);
  EXPECT_EQ(rig.latency().buckets(13).blocks_total(), 1U);
}

TEST_F(HealthTest, RefusedTare_IsTheStateOnlyWhereNoEarlierOneIsInUse) {
  session::RigState state{.rig = *rig_};
  const auto tare = [&state] { return status_snapshot({}, core::VirtualClock(), {state}, {}).rigs(0).tare(); };

  state.tare.outcome = pipeline::TareOutcome::Loaded;
  EXPECT_EQ(tare(), dts::v1::TARE_STATE_LOADED);
  state.tare.is_older_in_use = true;
  EXPECT_EQ(tare(), dts::v1::TARE_STATE_DONE);
}

/// Counts blocks by topic instead of sending them.
class CountingSocket final : public DataSocket {
 public:
  explicit CountingSocket(std::atomic<std::uint64_t>& raw_blocks) : raw_blocks_(raw_blocks) {}

  void send(std::string_view topic, const google::protobuf::MessageLite&) override {
    if (topic == "floor/raw") raw_blocks_.fetch_add(1, std::memory_order_relaxed);  // a count only
  }
  void wait(int bell_fd, int timeout_ms) override {
    pollfd bell{.fd = bell_fd, .events = POLLIN, .revents = 0};
    static_cast<void>(::poll(&bell, 1, timeout_ms));
  }
  bool take_subscriptions() override { return false; }
  bool drop_remote_peers() noexcept override { return true; }

 private:
  std::atomic<std::uint64_t>& raw_blocks_;
};

TEST_F(HealthTest, EveryPublishedBlock_HasItsLatencyCounted) {
  std::atomic<std::uint64_t> raw_blocks = 0;
  PublishThread publisher(std::make_unique<CountingSocket>(raw_blocks), bell_, {rig_.get()}, clock_, 7);
  static_cast<void>(publisher.start({}));
  rig_->start(core::Log());
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (raw_blocks < 50 && std::chrono::steady_clock::now() < deadline) std::this_thread::sleep_for(std::chrono::milliseconds(2));

  rig_->stop();
  publisher.stop();

  const dts::v1::LatencyHistogram histogram = latency_histogram(rig_->latency());
  EXPECT_GE(raw_blocks, 50U);
  EXPECT_EQ(histogram.buckets(13).blocks_total(), raw_blocks);
  EXPECT_GT(histogram.sum_ms(), 0.0);
  EXPECT_GT(rig_->ring_fill().frames_percent, 0.0) << "a frame waits at least until the publisher wakes up";
}

}  // namespace
}  // namespace dts::ipc
