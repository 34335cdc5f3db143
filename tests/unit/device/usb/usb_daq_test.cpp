// SPDX-License-Identifier: Apache-2.0
#include "device/usb/usb_daq.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/allocation_counter.h"

#include "unit/device/usb/toy_bench.h"

namespace dts::device::usb {
namespace {

using test::kMillisecond;
using test::kSecond;
using test::ToyBench;

std::string checks_text(const DeviceReport& report) {
  std::string text;
  for (const DeviceCheck& check : report.checks)
    text += check.name + " " + std::to_string(static_cast<int>(check.outcome)) + " " + check.detail + "\n";
  return text;
}

TEST(UsbDaq, SmallPackets_EveryScanInOrderAndInTime) {
  ToyBench bench;
  bench.run(100, 5);

  EXPECT_EQ(bench.read_until_trouble(10 * kSecond).outcome, ReadOutcome::Timeout);

  EXPECT_NEAR(static_cast<double>(bench.checker->scans()), 1000, 6);
  EXPECT_EQ(bench.checker->wrong(), 0U);
  EXPECT_FALSE(bench.device.used_large_packets);
  const core::Block& block = bench.checker->block();
  const std::int64_t truth_ns = bench.device.instant_ns(block.first_scan.value);
  EXPECT_LE(std::abs(block.host_time_ns - truth_ns), kMillisecond);
  EXPECT_LE(std::abs(block.host_time_ns - truth_ns), block.host_time_uncertainty_ns);
}

TEST(UsbDaq, ChannelsThatDoNotDividePackets_EveryScanInOrder) {
  for (const std::size_t channels : {1U, 3U, 5U, 6U, 7U, 8U}) {
    ToyBench bench({.driver = {.channels = channels}});
    bench.run(1500, 64);

    EXPECT_EQ(bench.read_until_trouble(3 * kSecond).outcome, ReadOutcome::Timeout) << channels;

    EXPECT_TRUE(bench.device.used_large_packets);
    EXPECT_NEAR(static_cast<double>(bench.checker->scans()), 4500, 100) << channels;
    EXPECT_EQ(bench.checker->wrong(), 0U) << channels;
  }
}

TEST(UsbDaq, MinutesAt8x1500_NoSampleWrong) {
  constexpr std::int64_t kSeconds = 120;  // the counters of codes and packets have wrapped by then
  ToyBench bench({.driver = {.channels = 8}, .has_marker = true});
  bench.run(1500, 64);

  EXPECT_EQ(bench.read_until_trouble(kSeconds * kSecond).outcome, ReadOutcome::Timeout);

  EXPECT_NEAR(static_cast<double>(bench.checker->scans()), 1500.0 * static_cast<double>(kSeconds), 100);
  EXPECT_EQ(bench.checker->wrong(), 0U);
}

TEST(UsbDaq, LateCompletions_NoFaultAndTimeStaysTrue) {
  ToyBench bench({.driver = {.channels = 8}});
  bench.device.faults.clock_error_ppm = 80;
  std::uint64_t noise = 1;
  bench.host.bus.lateness_ns = [&noise] {
    noise = noise * 6364136223846793005U + 1442695040888963407U;
    const auto draw = static_cast<std::int64_t>(noise >> 33U);
    return draw % 100 == 0 ? 40 * kMillisecond : draw % (2 * kMillisecond);
  };
  bench.run(1500, 15);

  EXPECT_EQ(bench.read_until_trouble(60 * kSecond).outcome, ReadOutcome::Timeout);

  EXPECT_EQ(bench.checker->wrong(), 0U);
  const core::Block& block = bench.checker->block();
  // The last scan of a transfer is heard of when its packet is full: 10 ms transfers of 2.7 ms packets.
  EXPECT_LE(std::abs(block.host_time_ns - bench.device.instant_ns(block.first_scan.value)), kMillisecond);
  EXPECT_NEAR(block.clock_drift_ppm, 80, 20);
}

TEST(UsbDaq, ReaderAwayForASecond_NothingLostAndReadAllocatesNothing) {
  ToyBench bench({.driver = {.channels = 8}, .has_marker = true});
  bench.run(1500, 15);
  ASSERT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);
  bench.host.bus.run_until(bench.host.clock.now_ns() + kSecond);

  const std::uint64_t before = dts::test::heap_calls_of_this_thread();
  for (int i = 0; i < 90; ++i) ASSERT_EQ(bench.checker->read(0).outcome, ReadOutcome::Scans);
  EXPECT_EQ(dts::test::heap_calls_of_this_thread(), before);
  EXPECT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);
  EXPECT_EQ(bench.checker->wrong(), 0U);
}

TEST(UsbDaq, Deadline_DeliversWhatIsThere) {
  ToyBench bench({.driver = {.has_single_readings = false}});
  bench.run(100, 50);
  const std::int64_t start_ns = bench.device.instant_ns(0);

  const ReadResult result = bench.checker->read(start_ns + 45 * kMillisecond);

  EXPECT_EQ(result.outcome, ReadOutcome::Scans);
  EXPECT_EQ(bench.checker->scans(), 5U);
  EXPECT_EQ(bench.host.clock.now_ns(), start_ns + 45 * kMillisecond);
}

TEST(UsbDaq, FirstScans_HeldBackUntilComparedWithSingleReadings) {
  ToyBench bench;
  bench.run(100, 1);
  const std::int64_t start_ns = bench.device.instant_ns(0);

  EXPECT_EQ(bench.checker->read(start_ns + 35 * kMillisecond).outcome, ReadOutcome::Timeout);
  EXPECT_EQ(bench.checker->read(start_ns + 45 * kMillisecond).outcome, ReadOutcome::Scans);
  EXPECT_EQ(bench.checker->wrong(), 0U);
  EXPECT_NE(checks_text(bench.daq->report()).find("single readings agree with the scan 1"), std::string::npos);
}

TEST(UsbDaq, RailCode_Marked) {
  ToyBench bench;
  bench.device.rail_at_code = 4 * 30 + 2;
  bench.run(100, 5);

  EXPECT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);

  EXPECT_EQ(bench.checker->rails(), 1U);
  EXPECT_EQ(bench.checker->wrong(), 0U);
}

TEST(UsbDaq, Interrupt_ReadReturnsAtOnceAndOnce) {
  ToyBench bench;
  bench.run(100, 64);
  ASSERT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);
  const std::int64_t before_ns = bench.host.clock.now_ns();

  bench.daq->interrupt();
  (void)bench.checker->read(before_ns + 10 * kSecond);
  EXPECT_LE(bench.host.clock.now_ns(), before_ns + 100 * kMillisecond);

  (void)bench.checker->read(bench.host.clock.now_ns() + 10 * kSecond);
  EXPECT_GT(bench.host.clock.now_ns(), before_ns + 500 * kMillisecond);
  EXPECT_EQ(bench.checker->wrong(), 0U);
}

TEST(UsbDaq, StopAndStart_NewSegmentFromScanZero) {
  ToyBench bench;
  ASSERT_TRUE(bench.daq->open().has_value());
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(bench.start(1500).has_value());
    EXPECT_EQ(bench.read_until_trouble(300 * kMillisecond).outcome, ReadOutcome::Timeout);
    EXPECT_GT(bench.checker->scans(), 300U);
    EXPECT_EQ(bench.checker->wrong(), 0U);
    EXPECT_TRUE(bench.daq->stop().has_value());
    EXPECT_EQ(bench.host.bus.transfers_in_flight(), 0);
    EXPECT_FALSE(bench.device.is_running());
  }
}

TEST(UsbDaq, AnotherScan_RemembersTheDrift) {
  ToyBench bench;
  bench.device.faults.clock_error_ppm = 60;
  bench.run(100, 5);
  ASSERT_EQ(bench.read_until_trouble(60 * kSecond).outcome, ReadOutcome::Timeout);
  ASSERT_TRUE(bench.daq->stop().has_value());
  ASSERT_TRUE(bench.start(100, 5).has_value());

  ASSERT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);

  EXPECT_NEAR(bench.checker->block().clock_drift_ppm, 60, 10);
}

TEST(UsbDaq, Trigger_ArmedUntilItComes) {
  ToyBench bench({.driver = {.has_single_readings = false, .waits_for_trigger = true}});
  bench.run(100, 5);

  for (int i = 0; i < 20; ++i) EXPECT_EQ(bench.checker->read(bench.host.clock.now_ns() + 100 * kMillisecond).outcome, ReadOutcome::Armed);
  bench.device.trigger(bench.host.clock.now_ns());

  EXPECT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);
  EXPECT_NEAR(static_cast<double>(bench.checker->scans()), 100, 6);
  EXPECT_EQ(bench.checker->wrong(), 0U);
}

TEST(UsbDaq, DeviceThatRecovers_ExactGapThenTheScansAfterIt) {
  for (std::size_t channel = 0; channel < 4; ++channel) {
    ToyBench bench;
    bench.device.gap_at_scan = 250;
    bench.device.gap_scans = 12;
    bench.device.gap_channel = channel;
    bench.run(1500, 15);

    const ReadResult gap = bench.read_until_trouble(kSecond);
    EXPECT_EQ(gap.outcome, ReadOutcome::Gap);
    EXPECT_EQ(gap.gap.reason, core::GapReason::Overrun);
    EXPECT_EQ(gap.gap.missing_scans, 12U);
    EXPECT_TRUE(gap.gap.is_exact);
    EXPECT_EQ(bench.checker->scans(), 250U);

    EXPECT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);
    EXPECT_GT(bench.checker->scans(), 1500U);
    EXPECT_EQ(bench.checker->wrong(), 0U) << channel;
    EXPECT_EQ(bench.device.begins, 1U);
    const core::Block& block = bench.checker->block();
    EXPECT_LE(std::abs(block.host_time_ns - bench.device.instant_ns(block.first_scan.value + 262)), 2 * kMillisecond);
  }
}

TEST(UsbDaq, TwoDevicesSideBySide_EachItsOwnScans) {
  ToyBench bench({.driver = {.channels = 8}, .serial = "T1"});
  test::ToyDevice second("B");
  bench.host.bus.plug(second);
  auto b = test::make_toy(bench.host, {.driver = {.channels = 3}, .serial = "B"});
  bench.run(1500, 15);
  ASSERT_TRUE(b->open().has_value());
  EXPECT_EQ(b->report().serial, "B");
  ASSERT_TRUE(b->start({*core::Rate::from_hz(100), 5}).has_value());
  test::Checker checker_b(*b, 5, false);
  const std::int64_t until_ns = bench.host.clock.now_ns() + 10 * kSecond;
  while (bench.host.clock.now_ns() < until_ns) {
    EXPECT_NE(bench.checker->read(bench.host.clock.now_ns() + 10 * kMillisecond).outcome, ReadOutcome::Broken);
    EXPECT_NE(checker_b.read(bench.host.clock.now_ns()).outcome, ReadOutcome::Broken);
  }
  bench.host.bus.unplug(second);
  EXPECT_EQ(checker_b.read(bench.host.clock.now_ns() + kSecond).outcome, ReadOutcome::Gone);
  EXPECT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);

  EXPECT_NEAR(static_cast<double>(bench.checker->scans()), 16'500, 30);
  EXPECT_NEAR(static_cast<double>(checker_b.scans()), 1000, 20);
  EXPECT_EQ(bench.checker->wrong() + checker_b.wrong(), 0U);
  b->close();
}

}  // namespace
}  // namespace dts::device::usb
