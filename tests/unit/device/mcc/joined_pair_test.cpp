// SPDX-License-Identifier: Apache-2.0
// Two USB-1608FS-Plus joined by SYNC, over emulated units whose pins are wired together.
#include "device/mcc/joined_pair.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/allocation_counter.h"
#include "unit/device/mcc/pair_bench.h"

namespace dts::device::mcc {
namespace {

using core::GapReason;
using emulator::FsPlusEmulator;
using emulator::FsPlusKind;
using test::Bench;
using test::kMillisecond;
using test::kPairUri;
using test::kSecond;
using test::moving_source;
using test::PairBench;
using test::Reading;
using test::Wired;

bool hears_sync(const Device& pair) {
  const std::vector<DeviceCheck> checks = pair.report().checks;
  return std::none_of(checks.begin(), checks.end(), [](const DeviceCheck& check) {
    return check.name == "the second unit receives SYNC" && check.outcome == DeviceCheck::Outcome::Failed;
  });
}

TEST(JoinedPair, SixteenChannelsAt1500Hz_EverySampleRightAtTheMastersTime) {
  RecordProperty("requirement", "ACQ-2");
  Wired units;
  PairBench bench(units);
  bench.start(1500);

  EXPECT_TRUE(bench.reads_right(15'000));
  ASSERT_EQ(bench.device->describe().channels.size(), 16U);
  EXPECT_EQ(bench.device->describe().channels[15].name, "ch15");
  EXPECT_EQ(units.first.last_start()[9], 2);  // SYNC out
  EXPECT_EQ((std::vector<std::uint8_t>(units.second.last_start().begin() + 4, units.second.last_start().begin() + 8)),
            (std::vector<std::uint8_t>{0, 0, 0, 0}));  // external clock

  core::Block block(16, 64);
  ASSERT_EQ(bench.device->read(block, bench.clock.now_ns() + kSecond).outcome, ReadOutcome::Scans);
  const std::int64_t newest_ns = block.host_time_ns + bench.rate.time_ns({block.count() - 1});
  EXPECT_NEAR(static_cast<double>(newest_ns), static_cast<double>(bench.clock.now_ns()), 12e6);  // a block of 8 ms, one being filled
}

TEST(JoinedPair, UnequalChannels_EverySampleRight) {
  Wired units;
  PairBench bench(units, "&channels=0,1,2,3,4,5,6&second_channels=1,4,6&second_range_v=10");
  bench.start(1500, 30);

  EXPECT_TRUE(bench.reads_right(15'000));
  EXPECT_EQ(bench.device->describe().channels[7].name, "ch9");
}

TEST(JoinedPair, TenMinutesAt100Hz_StaysAligned) {
  Wired units;
  units.first.faults.clock_error_ppm = 80.0;
  PairBench bench(units, "&channels=0,1&second_channels=0,1");
  bench.start(100, 2);

  EXPECT_TRUE(bench.reads_right(100 * 600));
}

TEST(JoinedPair, BusyHost_NoFalseAlarm) {
  for (const char* second : {"0,1,2,3", "0,1,2,3,4,5,6,7"}) {
    Wired units;
    PairBench bench(units, std::string("&channels=0,1,2,3&second_channels=") + second);
    std::uint32_t noise = 1;
    bench.bus.lateness_ns = [&noise] {
      noise = noise * 1'664'525U + 1'013'904'223U;
      return std::int64_t{noise >> 8U} % (3 * kMillisecond);
    };
    bench.start(1500, 30);

    EXPECT_TRUE(bench.reads_right(1500 * 20)) << second;
  }
}

TEST(JoinedPair, SyncWireBreaks_BothBreak) {
  Wired units;
  PairBench bench(units);
  bench.start(1500);
  ASSERT_TRUE(bench.reads_right(3000));
  const std::int64_t before_ns = bench.clock.now_ns();

  units.line.cut(bench.clock.now_ns());
  const Reading reading = bench.read(30'000);

  EXPECT_EQ(reading.wrong, 0U);
  EXPECT_EQ(reading.last.outcome, ReadOutcome::Broken);
  EXPECT_EQ(reading.last.gap.reason, GapReason::Silence);
  EXPECT_LT(bench.clock.now_ns() - before_ns, 800 * kMillisecond);
  EXPECT_FALSE(hears_sync(*bench.device));
  EXPECT_EQ(bench.read(1).last.outcome, ReadOutcome::Broken);  // until stop
}

TEST(JoinedPair, NoWire_NoScansAndBroken) {
  FsPlusEmulator first(FsPlusKind::Usb1608, "AAAA0001", moving_source());
  FsPlusEmulator second(FsPlusKind::Usb1608, "BBBB0002", moving_source(8));
  Bench bench(kPairUri, first);
  bench.bus.plug(second);
  bench.start(1500);

  const Reading reading = bench.read(30'000);

  EXPECT_EQ(reading.scans, 0U);
  EXPECT_EQ(reading.last.outcome, ReadOutcome::Broken);
  EXPECT_FALSE(hears_sync(*bench.device));
  ASSERT_TRUE(bench.device->stop());
  EXPECT_FALSE(hears_sync(*bench.device));  // still known when somebody asks
  bench.bus.unplug(second);
}

TEST(JoinedPair, MasterFallsSilent_TheWireIsNotBlamed) {
  for (const char* options : {"", "&channels=0&second_channels=0,1,2", "&channels=0,1,2&second_channels=1"}) {
    Wired units;
    PairBench bench(units, options);
    bench.start(1500);
    ASSERT_TRUE(bench.reads_right(3000));

    units.line.cut(bench.clock.now_ns());
    units.first.faults.silence_at_code = 0;

    EXPECT_EQ(bench.read(30'000).last.gap.reason, GapReason::Silence);
    EXPECT_TRUE(hears_sync(*bench.device)) << options;
  }
}

TEST(JoinedPair, ScansOfOneUnitLost_BrokenWithinFourSeconds) {
  for (const bool is_second : {false, true}) {
    Wired units;
    PairBench bench(units);
    bench.start(1500);
    ASSERT_TRUE(bench.reads_right(30'000));

    (is_second ? units.second : units.first).faults.drop_packet_at_code = 8 * 32'000;  // four whole scans: no marker could tell

    const Reading reading = bench.read(60'000);
    EXPECT_EQ(reading.last.outcome, ReadOutcome::Broken) << is_second;
    EXPECT_EQ(reading.last.gap.reason, GapReason::Integrity);
    EXPECT_LT(reading.scans, 2000U + 4U * 1500U);
  }
}

TEST(JoinedPair, OnePulseLostAt100Hz_Broken) {
  Wired units;
  PairBench bench(units);
  bench.start(100, 10);
  ASSERT_TRUE(bench.reads_right(1000));

  units.second.faults.drop_packet_at_code = 8 * 1200;  // immediate: a packet is one scan

  EXPECT_EQ(bench.read(3000).last.gap.reason, GapReason::Integrity);
}

TEST(JoinedPair, FaultOfEither_IsAFaultOfBoth) {
  for (const bool is_second : {false, true}) {
    Wired units;
    PairBench bench(units);
    bench.start(1500);
    (is_second ? units.second : units.first).faults.overrun_at_code = 20'000;

    const Reading reading = bench.read(30'000);

    EXPECT_EQ(reading.wrong, 0U);
    EXPECT_EQ(reading.last.outcome, ReadOutcome::Broken);
    EXPECT_EQ(reading.last.gap.reason, GapReason::Overrun) << is_second;
    EXPECT_EQ(reading.last.gap.missing_scans, 0U);
    EXPECT_FALSE(reading.last.gap.is_exact) << "nobody knows how many are missing";
    EXPECT_TRUE(hears_sync(*bench.device));
    ASSERT_TRUE(bench.device->stop());
    bench.begin_segment();
    bench.start(1500);
    EXPECT_TRUE(bench.reads_right(3000));
  }
}

TEST(JoinedPair, EitherUnplugged_GoneUntilClosedAndPluggedInAgain) {
  for (const bool is_second : {false, true}) {
    Wired units;
    PairBench bench(units, "&sync_output_bit=0");
    FsPlusEmulator& victim = is_second ? units.second : units.first;
    EXPECT_EQ(bench.device->report().serial, "");
    bench.start(1500);
    EXPECT_EQ(bench.device->report().serial, "AAAA0001+BBBB0002");
    EXPECT_TRUE(bench.device->set_sync_output(true));
    ASSERT_TRUE(bench.reads_right(3000));

    bench.bus.unplug(victim);
    EXPECT_EQ(bench.read(30'000).last.outcome, ReadOutcome::Gone);
    EXPECT_EQ(bench.device->state(), DeviceState::Gone);
    EXPECT_EQ(bench.device->set_sync_output(true).error().code, core::ErrorCode::DeviceGone);
    EXPECT_TRUE(bench.device->close());
    EXPECT_EQ(bench.device->open().error().code, core::ErrorCode::NotFound);
    EXPECT_EQ(bench.bus.open_ports(), 0);
    EXPECT_EQ(bench.bus.transfers_in_flight(), 0);

    bench.bus.plug(victim);
    EXPECT_TRUE(bench.device->has_arrived());
    bench.begin_segment();
    bench.start(1500);
    EXPECT_TRUE(bench.reads_right(3000));
  }
}

TEST(JoinedPair, BlockSmallerThanStarted_FullAfterItsOwnTimeUnlessInterrupted) {
  Wired units;
  PairBench bench(units);
  bench.start(1000, 256);
  core::Block small(16, 100);
  ASSERT_EQ(bench.device->read(small, bench.clock.now_ns() + kSecond).outcome, ReadOutcome::Scans);
  std::int64_t before_ns = bench.clock.now_ns();

  ASSERT_EQ(bench.device->read(small, before_ns + 10 * kSecond).outcome, ReadOutcome::Scans);

  EXPECT_EQ(small.count(), 100U);
  EXPECT_EQ(small.first_scan.value, 100U);
  EXPECT_LE(bench.clock.now_ns() - before_ns, 150 * kMillisecond);

  ASSERT_TRUE(bench.device->stop());
  bench.start(10, 64);
  before_ns = bench.clock.now_ns();
  bench.device->interrupt();
  EXPECT_EQ(bench.device->read(small, before_ns + 10 * kSecond).outcome, ReadOutcome::Timeout);
  EXPECT_LE(bench.clock.now_ns() - before_ns, 100 * kMillisecond);
}

TEST(JoinedPair, Read_AllocatesNothing) {
  Wired units;
  PairBench bench(units);
  bench.start(1500);
  core::Block block(16, 64);
  bench.bus.run_until(bench.clock.now_ns() + kSecond);  // the emulators allocate, in this thread
  const std::uint64_t before = dts::test::heap_calls_of_this_thread();

  for (int i = 0; i < 20; ++i) EXPECT_EQ(bench.device->read(block, bench.clock.now_ns()).outcome, ReadOutcome::Scans);

  EXPECT_EQ(dts::test::heap_calls_of_this_thread(), before);
}

}  // namespace
}  // namespace dts::device::mcc
