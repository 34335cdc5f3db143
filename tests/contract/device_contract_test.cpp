// SPDX-License-Identifier: Apache-2.0
// What every device promises (the table in device/device.h). A new device adds one line to kDevices in device_contract.h.
#include "contract/device_contract.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <thread>

#include "support/allocation_counter.h"

namespace dts::device::contract {
namespace {

TEST_P(DeviceContract, Created_IsDescribedCompletelyBeforeOpen) {
  const auto device = create(GetParam().uri);

  const DeviceDescription& description = device->describe();

  EXPECT_EQ(device->state(), DeviceState::Closed);
  EXPECT_EQ(description.uri, GetParam().uri);
  EXPECT_FALSE(description.model.empty());
  EXPECT_GT(description.minimum_rate_hz, 0.0);
  EXPECT_GE(description.maximum_rate_hz, description.minimum_rate_hz);
  ASSERT_FALSE(description.channels.empty());
  EXPECT_LE(description.channels.size(), core::kMaxChannels);
  EXPECT_EQ(description.channels[0].role, ChannelRole::Sensor);
  std::set<std::string> names;
  for (const ChannelDescription& channel : description.channels) {
    EXPECT_TRUE(names.insert(channel.name).second) << channel.name << " stands twice";
    EXPECT_FALSE(channel.unit.empty()) << channel.name;
    EXPECT_LT(channel.minimum, channel.maximum) << channel.name;
    EXPECT_GE(channel.resolution, 0.0) << channel.name;
  }
}

TEST_P(DeviceContract, Gone_EveryOperationAsTheTableSays) {
  if (!can_unplug()) GTEST_SKIP() << "cannot be unplugged on request";
  const auto device = gone();
  core::Block block = block_for(*device, 8);

  EXPECT_EQ(device->state(), DeviceState::Gone);
  EXPECT_FALSE(device->describe().channels.empty());
  EXPECT_EQ(code(device->open()), core::ErrorCode::WrongState);
  EXPECT_EQ(code(device->start(usual(*device))), core::ErrorCode::DeviceGone);
  EXPECT_EQ(device->read(block, test::kNoDeadline).outcome, ReadOutcome::Gone);
  EXPECT_TRUE(device->stop().has_value());
  EXPECT_EQ(device->state(), DeviceState::Gone);
  EXPECT_TRUE(device->close().has_value());
  EXPECT_EQ(device->state(), DeviceState::Closed);
}

TEST_P(DeviceContract, SyncOutput_AsTheTableSays) {
  const auto device = create(GetParam().uri);
  EXPECT_EQ(code(device->set_sync_output(true)), core::ErrorCode::WrongState);
  ASSERT_TRUE(device->open().has_value());
  const core::ErrorCode open = code(device->set_sync_output(true));
  EXPECT_TRUE(open == core::ErrorCode{} || open == core::ErrorCode::Unsupported);
  ASSERT_TRUE(device->start(usual(*device)).has_value());
  EXPECT_EQ(code(device->set_sync_output(false)), open);
  ASSERT_TRUE(device->close().has_value());
  if (can_unplug()) {
    EXPECT_EQ(code(gone()->set_sync_output(true)), core::ErrorCode::DeviceGone);
  }
}

TEST_P(DeviceContract, Report_NamesTheUnitInEveryStateAfterOpen) {
  const auto device = create(GetParam().uri);
  (void)device->report();
  ASSERT_TRUE(device->open().has_value());
  const std::string serial = device->report().serial;
  EXPECT_TRUE(!serial.empty() || !knows_its_serial(*device));
  ASSERT_TRUE(device->start(usual(*device)).has_value());
  core::Block block = block_for(*device, 8);
  ASSERT_EQ(device->read(block, test::kNoDeadline).outcome, ReadOutcome::Scans);
  EXPECT_EQ(device->report().serial, serial);
  for (const DeviceCheck& check : device->report().checks) {
    EXPECT_NE(check.outcome, DeviceCheck::Outcome::Failed) << check.name << ": " << check.detail;
  }
  ASSERT_TRUE(device->close().has_value());
  EXPECT_EQ(device->report().serial, serial);
}

TEST_P(DeviceContract, ExactRate_IsNearTheWishAndOutsideTheLimitsRefused) {
  const auto device = create(GetParam().uri);
  const DeviceDescription& description = device->describe();
  for (const double rate_hz : {100.0, 1000.0, 1500.0}) {
    if (rate_hz > description.maximum_rate_hz) continue;
    const auto exact = device->exact_rate(test::rate_of(rate_hz));
    ASSERT_TRUE(exact.has_value());
    EXPECT_NEAR(exact->hz(), rate_hz, 1e-4 * rate_hz);
    EXPECT_EQ(device->exact_rate(*exact).value(), *exact) << "asking for what it can do gives just that";
  }
  EXPECT_EQ(code(device->exact_rate(test::rate_of(1.01 * description.maximum_rate_hz))), core::ErrorCode::InvalidArgument);
}

TEST_P(DeviceContract, PluggedInAgain_StreamsFromIndexZero) {
  if (!can_unplug()) GTEST_SKIP() << "cannot be unplugged on request";
  if (!GetParam().comes_back) GTEST_SKIP() << "what has ended does not come back";
  const auto device = gone();
  ASSERT_TRUE(device->close().has_value());
  bring_back();
  core::Block block = block_for(*device, 8);

  ASSERT_TRUE(device->open().has_value());
  ASSERT_TRUE(device->start(usual(*device)).has_value());

  EXPECT_EQ(device->read(block, test::kNoDeadline).outcome, ReadOutcome::Scans);
  EXPECT_EQ(block.first_scan.value, 0U);
}

TEST_P(DeviceContract, RandomSequences_FollowTheStateTable) {
  RecordProperty("requirement", "ACQ-3");
  bool has_left = false;
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const bool unplugs = seed % 2 == 0 && GetParam().unplugging_uri[0] != '\0';
    const auto device = create(unplugs ? GetParam().unplugging_uri : GetParam().uri);
    core::Block block = block_for(*device, 1 + random() % 64);
    Model model{.may_leave_anywhere = unplugs && GetParam().make_device != nullptr};
    for (int step = 0; step < 60 && !HasFailure(); ++step) {
      switch (random() % 12) {
        case 0: model.check_open(*device); break;
        case 1: model.check_start(*device, usual(*device)); break;
        case 2: model.check_stop(*device); break;
        case 3: model.check_close(*device); break;
        case 4: device->interrupt(); break;
        case 5: model.check_report(*device); break;
        case 6: model.check_sync_output(*device, random() % 2 == 0); break;
        case 7: (void)device->has_arrived(); break;
        case 8: EXPECT_EQ(code(device->exact_rate(usual(*device).rate)), core::ErrorCode{}); break;
        default: model.check_read(*device, block, clock_.now_ns() + static_cast<std::int64_t>(random() % 500) * kMillisecond); break;
      }
      EXPECT_EQ(device->state(), model.state);
      has_left = has_left || model.state == DeviceState::Gone;
    }
  }
  EXPECT_EQ(has_left, GetParam().unplugging_uri[0] != '\0') << "a device that can leave does so in some sequence";
}

TEST_P(DeviceContract, BothEndsOfTheRate_ExactRateAndInstants) {
  const auto device = create(GetParam().uri);
  ASSERT_TRUE(device->open().has_value());
  for (const double rate_hz : {device->describe().minimum_rate_hz, device->describe().maximum_rate_hz}) {
    SCOPED_TRACE(rate_hz);
    const auto rate = device->start({test::rate_of(rate_hz), 16});
    ASSERT_TRUE(rate.has_value());
    EXPECT_NEAR(rate->hz(), rate_hz, 0.01 * rate_hz);
    core::Block block = block_for(*device, 16);
    ASSERT_EQ(device->read(block, test::kNoDeadline).outcome, ReadOutcome::Scans);
    const std::int64_t first_ns = block.host_time_ns;
    ASSERT_EQ(device->read(block, test::kNoDeadline).outcome, ReadOutcome::Scans);
    const auto expected_ns = static_cast<double>(rate->time_ns(block.first_scan));
    const auto doubt_ns = static_cast<double>(block.host_time_uncertainty_ns);  // 0 for a device that knows
    EXPECT_NEAR(static_cast<double>(block.host_time_ns - first_ns), expected_ns, 1e-3 * expected_ns + doubt_ns);
    EXPECT_EQ(*rate, device->exact_rate(test::rate_of(rate_hz)).value());
    EXPECT_TRUE(device->stop().has_value());
  }
}

TEST_P(DeviceContract, BadStartOptions_RefusedAndStillOpen) {
  const auto device = create(GetParam().uri);
  ASSERT_TRUE(device->open().has_value());
  const DeviceDescription& description = device->describe();
  const StartOptions good = usual(*device);
  const std::array<StartOptions, 4> bad = {{{test::rate_of(0.5 * description.minimum_rate_hz), 64},
                                            {test::rate_of(1.01 * description.maximum_rate_hz), 64},
                                            {good.rate, 0},
                                            {good.rate, core::kMaxBlockScans + 1}}};

  for (const StartOptions& options : bad) {
    const auto started = device->start(options);
    EXPECT_EQ(code(started), core::ErrorCode::InvalidArgument);
    EXPECT_EQ(device->state(), DeviceState::Open);
  }
  EXPECT_TRUE(device->start(good).has_value());
}

TEST_P(DeviceContract, Blocks_ContinueWithoutHoleAtAnyCapacity) {
  const auto device = create(GetParam().uri);
  ASSERT_TRUE(device->open().has_value());
  for (const std::size_t capacity : {std::size_t{1}, std::size_t{64}}) {
    SCOPED_TRACE(capacity);
    const auto rate = device->start(usual(*device, capacity));
    ASSERT_TRUE(rate.has_value());
    core::Block block = block_for(*device, capacity);
    std::uint64_t next = 0;
    std::int64_t last_time_ns = 0;
    std::int64_t start_ns = 0;
    while (next < 1000) {
      ASSERT_EQ(device->read(block, clock_.now_ns() + kSecond / 4).outcome, ReadOutcome::Scans);
      ASSERT_GE(block.count(), 1U);
      ASSERT_LE(block.count(), capacity);
      ASSERT_EQ(block.first_scan.value, next);
      ASSERT_GT(block.host_time_ns, last_time_ns);
      if (next == 0) start_ns = block.host_time_ns;
      const auto nominal_ns = static_cast<double>(rate->time_ns({next}));
      const auto doubt_ns = static_cast<double>(block.host_time_uncertainty_ns);
      ASSERT_NEAR(static_cast<double>(block.host_time_ns - start_ns), nominal_ns, 1e-3 * nominal_ns + 1e6 + doubt_ns);
      last_time_ns = block.host_time_ns;
      next += block.count();
    }
    ASSERT_TRUE(device->stop().has_value());
  }
}

TEST_P(DeviceContract, ConvertedValues_WithinTheDescribedRange) {
  const auto device = streaming(GetParam().uri);
  core::Block block = block_for(*device, 64);
  for (int i = 0; i < 20; ++i) {
    ASSERT_EQ(device->read(block, test::kNoDeadline).outcome, ReadOutcome::Scans);
    for (std::size_t channel = 0; channel < block.channel_count(); ++channel) {
      const ChannelDescription& described = device->describe().channels[channel];
      for (std::size_t scan = 0; scan < block.count(); ++scan) {
        const double value = block.column(channel)[scan];
        const bool says_why = std::isnan(value) && block.quality(channel)[scan] != 0;
        ASSERT_TRUE(says_why || (value >= described.minimum && value <= described.maximum)) << described.name << " = " << value;
      }
    }
  }
}

TEST_P(DeviceContract, Gap_IndexRestartsAndTheCountFillsTheHole) {
  RecordProperty("requirement", "ACQ-4");
  if (GetParam().gapping_uri[0] == '\0') GTEST_SKIP() << "cannot be made to lose scans on request";
  const auto device = streaming(GetParam().gapping_uri);
  core::Block block = block_for(*device, 64);
  std::uint64_t before = 0;
  std::int64_t start_ns = 0;
  ReadResult read;
  for (int i = 0; i < 1000 && read.outcome != ReadOutcome::Gap; ++i) {
    read = device->read(block, clock_.now_ns() + kSecond);
    if (before == 0 && block.count() > 0) start_ns = block.host_time_ns;
    before += block.count();
  }
  ASSERT_EQ(read.outcome, ReadOutcome::Gap);

  ASSERT_EQ(device->read(block, clock_.now_ns() + kSecond).outcome, ReadOutcome::Scans);

  EXPECT_NE(read.gap.reason, core::GapReason::None);
  EXPECT_EQ(block.first_scan.value, 0U);
  const double elapsed_scans = 1e-9 * static_cast<double>(block.host_time_ns - start_ns) * usual(*device).rate.hz();
  EXPECT_NEAR(static_cast<double>(before + read.gap.missing_scans), elapsed_scans, read.gap.is_exact ? 0.5 : 2.0);
}

/// Single scans are asked for, and the reader is late at times: then several wait.
TEST_P(DeviceContract, HasMore_IsTrueOnlyIfTheNextReadDoesNotWait) {
  const auto device = create(GetParam().uri);
  EXPECT_FALSE(device->has_more());
  ASSERT_TRUE(device->open().has_value());
  EXPECT_FALSE(device->has_more());
  ASSERT_TRUE(device->start(usual(*device, 1)).has_value());
  core::Block block = block_for(*device, 1);
  for (int scan = 0; scan < 200; ++scan) {
    if (scan % 20 == 19) clock_.sleep_until_ns(clock_.now_ns() + 50 * kMillisecond);
    const bool has_more = device->has_more();
    const std::int64_t before_ns = clock_.now_ns();
    ASSERT_EQ(device->read(block, before_ns + kSecond).outcome, ReadOutcome::Scans);
    EXPECT_TRUE(!has_more || clock_.now_ns() == before_ns) << scan;
  }
  ASSERT_TRUE(device->stop().has_value());
  EXPECT_FALSE(device->has_more());
}

TEST_P(DeviceContract, Deadline_IsKept) {
  const auto device = streaming(GetParam().uri);
  core::Block block = block_for(*device, 64);
  const std::int64_t deadline_ns = clock_.now_ns() + 3 * kMillisecond;

  (void)device->read(block, deadline_ns);

  EXPECT_LE(clock_.now_ns(), deadline_ns + kMillisecond);
}

TEST_P(DeviceContract, InterruptWhileWaiting_ReturnsWithin100Milliseconds) {
  if (is_on_usb()) GTEST_SKIP() << "waits on its port, not on the clock: see unit_device";
  ClockWithVisitor clock;
  const auto device = create_on(GetParam().uri, clock);
  ASSERT_TRUE(device->open().has_value());
  ASSERT_TRUE(device->start({test::rate_of(device->describe().minimum_rate_hz), 64}).has_value());
  core::Block block = block_for(*device, 64);
  std::int64_t interrupted_at_ns = 0;
  clock.on_sleep = [&] {
    interrupted_at_ns = clock.now_ns();
    device->interrupt();
  };

  (void)device->read(block, test::kNoDeadline);

  ASSERT_GT(interrupted_at_ns, 0);
  EXPECT_LE(clock.now_ns(), interrupted_at_ns + 100 * kMillisecond);
}

TEST_P(DeviceContract, InterruptFromAnotherThread_EndsTheRead) {
  if (is_on_usb()) GTEST_SKIP() << "the bus in the test has one thread: see usb_umockdev";
  core::SystemClock clock;
  const auto device = create_on(GetParam().uri, clock);
  ASSERT_TRUE(device->open().has_value());
  ASSERT_TRUE(device->start({test::rate_of(device->describe().minimum_rate_hz), 64}).has_value());
  std::atomic<bool> has_returned{false};

  std::jthread reader([&] {
    core::Block block = block_for(*device, 64);
    (void)device->read(block, test::kNoDeadline);
    has_returned.store(true, std::memory_order_release);
  });
  while (!has_returned.load(std::memory_order_acquire)) {
    device->interrupt();
    std::this_thread::yield();
  }
  reader.join();

  EXPECT_TRUE(device->stop().has_value());
}

TEST_P(DeviceContract, Stop_ReturnsWithin250Milliseconds) {
  const auto device = streaming(GetParam().uri);
  const std::int64_t before_ns = clock_.now_ns();

  EXPECT_TRUE(device->stop().has_value());

  EXPECT_LE(clock_.now_ns(), before_ns + 250 * kMillisecond);
}

TEST_P(DeviceContract, DestroyedWhileStreaming_CanBeOpenedAnew) {
  streaming(GetParam().uri).reset();

  const auto again = streaming(GetParam().uri);

  EXPECT_EQ(again->state(), DeviceState::Streaming);
}

TEST_P(DeviceContract, Read_AllocatesNothing) {
  RecordProperty("requirement", "ACQ-11");
  if (is_on_usb()) GTEST_SKIP() << "the bus in the test allocates in this thread: see usb_umockdev";
  for (const char* uri : {GetParam().uri, GetParam().unplugging_uri, GetParam().gapping_uri}) {
    if (uri[0] == '\0') continue;
    const auto device = streaming(uri);
    core::Block block = block_for(*device, 64);
    const std::uint64_t before = dts::test::heap_calls_of_this_thread();

    for (int i = 0; i < 50; ++i) (void)device->read(block, clock_.now_ns() + kSecond);

    EXPECT_EQ(dts::test::heap_calls_of_this_thread(), before) << uri;
  }
}

INSTANTIATE_TEST_SUITE_P(Devices, DeviceContract, testing::ValuesIn(kDevices),
                         [](const testing::TestParamInfo<DeviceUnderTest>& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace dts::device::contract
