// SPDX-License-Identifier: Apache-2.0
// A rig with its real thread on the simulated floor.
#include "session/rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>

#include "floor_config.h"
#include "support/allocation_counter.h"
#include "support/patient_clock.h"

namespace dts::session {
namespace {

/// Reads frames of a started rig until `wanted` returns true, waiting on the bell; false after 60 s.
bool read_until(core::FrameReader& frames, core::Doorbell& bell, const std::function<bool(const core::Frame&)>& wanted) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (std::chrono::steady_clock::now() < deadline) {
    while (const core::Frame* frame = frames.front()) {
      const bool is_wanted = wanted(*frame);
      frames.release();
      if (is_wanted) return true;
    }
    bell.wait(100);
  }
  return false;
}

TEST(Rig, AfterStart_ItsThreadAllocatesNothing) {
  RecordProperty("requirement", "ACQ-11");
  core::SystemClock clock;
  core::Doorbell bell;
  auto rig = Rig::create(floor_config("sim:floor?seed=3&step_on_s=0.5"), clock, bell).value();
  core::FrameReader frames(rig->frames(), rig->frames().capacity());
  rig->start(core::Log());
  std::uint64_t scans = 0;
  ASSERT_TRUE(read_until(frames, bell, [&](const core::Frame& frame) { return (scans += frame.streams[0].count()) > 100; }));

  test::count_sample_threads(true);
  rig->tap().open();  // a recording is no reason to allocate either
  std::uint64_t tapped_scans = 0;
  ASSERT_TRUE(read_until(frames, bell, [&](const core::Frame& frame) {
    for (auto item = rig->tap().front(); item; item = rig->tap().front()) {
      tapped_scans += item->frame->streams[0].count();
      rig->tap().release();
    }
    return (scans += frame.streams[0].count()) > 3000;
  }));
  EXPECT_GT(tapped_scans, 2000U);
  test::count_sample_threads(false);

  EXPECT_EQ(test::heap_calls_of_sample_threads(), 0U);
}

/// Publishes what the rig's thread offers, or leaves it to another thread.
class CountingPublisher final : public FramePublisher {
 public:
  [[nodiscard]] bool publish() noexcept override {
    ++calls;
    return can_publish;
  }
  std::atomic<int> calls = 0;
  std::atomic<bool> can_publish = true;
};

TEST(Rig, FramesThatItsPublisherLeaves_RingTheBell) {
  core::SystemClock clock;
  core::Doorbell bell;
  CountingPublisher publisher;
  auto rig = Rig::create(floor_config("sim:floor?seed=3"), clock, bell).value();
  rig->publish_with(publisher);
  rig->start(core::Log());
  while (publisher.calls < 3) std::this_thread::yield();
  EXPECT_FALSE(bell.wait(0));
  publisher.can_publish = false;
  EXPECT_TRUE(bell.wait(60'000));
  rig->stop();
}

TEST(Rig, ReaderThatStalls_LosesFramesButNeitherTheCountNorTheGap) {
  RecordProperty("requirement", "ACQ-12");
  test::PatientClock clock;  // on a busy machine, the device would have more overruns than the test causes
  core::Doorbell bell;
  // The overrun happens while nobody reads: the reader has lost the frame with its gap.
  auto rig = Rig::create(floor_config("sim:floor?seed=3&fault=overrun&fault_at_s=0.1&fault_for_s=0.1"), clock, bell).value();
  core::FrameReader frames(rig->frames(), 8);
  rig->start(core::Log());
  clock.start();
  while (rig->acquisition().scans_total < 1500) bell.wait(100);
  core::Gap gap;
  std::uint64_t scans = 0;

  ASSERT_TRUE(read_until(frames, bell, [&](const core::Frame& frame) {
    if (frame.gap_before.reason != core::GapReason::None) gap = frame.gap_before;
    scans += frame.streams[0].count();
    return gap.reason != core::GapReason::None;
  }));

  EXPECT_GT(frames.lost_frames(), 0U);
  EXPECT_EQ(frames.position().scans, scans + frames.lost_scans());
  EXPECT_EQ(gap.reason, core::GapReason::Overrun);
  EXPECT_EQ(gap.missing_scans, 150U);
  EXPECT_EQ(rig->acquisition().losses.total().scans, 150U);
}

TEST(Rig, ConfigurationsThatDoNotFitTheDevice_AreRefusedWithTheirReason) {
  const auto refusal = [](const std::string& uri, const std::function<void(pipeline::RigConfig&)>& change) {
    core::SystemClock clock;
    core::Doorbell bell;
    pipeline::RigConfig config = floor_config(uri);
    change(config);
    const auto rig = Rig::create(config, clock, bell);
    return rig ? "" : core::to_string(rig.error());
  };
  EXPECT_EQ(refusal("sim:floor?truth=0", [](auto& config) { config.sensor_channels[3] = 9; }),
            "rig 'floor': a sensor is on channel 9, but sim:floor?truth=0 has 4 channels");
  const auto put_on_force_plate = [](auto& config) {
    const physics::LoadCellPlate cells{.cells = {{200, 150, 100}, {-200, 150, 100}, {0, -150, 100}}};
    config.model.sensors.clear();
    config.model.force_plate = physics::ForcePlateModel{
        .plate = physics::ForcePlate::create(cells).value(), .channel_names = {"cell1", "cell2", "cell3"}, .tare_v = {0.0, 0.0, 0.0}};
    config.sensor_channels = {0, 1, 20};
  };
  EXPECT_EQ(refusal("sim:floor", put_on_force_plate), "device \"sim:floor\": sim:floor has no force plate; use sim:stack?part=plate");
  EXPECT_THAT(refusal("sim:stack?part=plate", put_on_force_plate),
              testing::AllOf(testing::HasSubstr("rig 'floor': the force plate needs 21 channels, but sim:stack?part=plate has 9 channels"),
                             testing::HasSubstr("channels=0,1,2,3,4,")));
  EXPECT_EQ(refusal("sim:floor", [](auto& config) { config.rate = core::Rate::create(500'000, 1).value(); }),
            "rig 'floor': sim:floor cannot run at 500000.000000 Hz (choose 1.000000 to 20000.000000 Hz)");
  EXPECT_EQ(refusal("sim:floor?extra=1", [](auto& config) { config.trigger = pipeline::TriggerInput{.channel = 4, .level = 25.0}; }),
            "rig 'floor': [trigger] level and hysteresis lie outside what channel extra0 can measure, -5.000000 .. 4.995117 V");
  EXPECT_EQ(refusal("sim:floor", [](auto& config) { config.sync_pulse_ms = 100.0; }),
            "rig 'floor': [session] sync_pulse_ms needs a device with a sync output (for an MCC device, add sync_output_bit=0 to the "
            "device address)");
  EXPECT_EQ(refusal("sim:floor", [](auto& config) { config.published = {"copp"}; }),
            "rig 'floor' has no stream 'copp' to publish (it has: raw, filtered, deflection, cop, aux)");
}

TEST(Rig, WithoutAListOfStreams_PublishesAllOfThem) {
  core::SystemClock clock;
  core::Doorbell bell;
  pipeline::RigConfig config = floor_config("sim:floor");
  config.published = {};

  const auto rig = Rig::create(config, clock, bell).value();

  std::vector<std::string> all;
  for (const core::StreamFormat& format : rig->formats()) all.push_back(format.name);
  EXPECT_EQ(rig->config().published, all);
}

TEST(Rig, StopWithoutStartAndTwice_IsHarmless) {
  core::SystemClock clock;
  core::Doorbell bell;
  auto rig = Rig::create(floor_config("sim:floor"), clock, bell).value();

  rig->stop();
  rig->start(core::Log());
  rig->stop();
  rig->stop();

  EXPECT_EQ(rig->acquisition().device, device::DeviceState::Closed);
}

}  // namespace
}  // namespace dts::session
