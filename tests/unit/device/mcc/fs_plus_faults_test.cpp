// SPDX-License-Identifier: Apache-2.0
// What goes wrong with a USB-1608FS-Plus: each fault is found, told with its reason, and no wrong value comes before it.
#include "device/mcc/fs_plus.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "unit/device/mcc/mcc_bench.h"
#include "usb/emulator/fs_plus_emulator.h"

namespace dts::device::mcc {
namespace {

using core::GapReason;
using emulator::FsPlusEmulator;
using emulator::FsPlusKind;
using test::Bench;
using test::kMillisecond;
using test::kSecond;
using test::moving_source;
using test::Reading;

FsPlusEmulator faulty_1608() { return {FsPlusKind::Usb1608, "01A2B3C4", moving_source()}; }

TEST(FsPlusFaults, FaultOfTheStream_ToldWithItsReasonThenEverySampleRightAgain) {
  struct Row {
    std::uint64_t emulator::Faults::*fault;
    std::uint64_t at_code;
    GapReason reason;
  };
  for (const Row& row :
       {Row{&emulator::Faults::overrun_at_code, 8003, GapReason::Overrun}, Row{&emulator::Faults::stall_at_code, 8003, GapReason::Stall},
        Row{&emulator::Faults::short_packet_at_code, 8003, GapReason::Integrity},
        Row{&emulator::Faults::babble_at_code, 8003, GapReason::Integrity},
        Row{&emulator::Faults::drop_code_at, 0, GapReason::Integrity}}) {
    FsPlusEmulator unit = faulty_1608();
    Bench bench("mcc:1608fs-plus", unit);
    unit.faults.*row.fault = row.at_code;
    bench.start(1500);

    const Reading reading = bench.read(3000);

    EXPECT_EQ(reading.last.outcome, ReadOutcome::Broken);
    EXPECT_EQ(reading.last.gap.reason, row.reason);
    EXPECT_EQ(reading.scans > 0, row.at_code > 0) << "nothing is delivered of a scan that begins rotated";
    EXPECT_EQ(reading.wrong, 0U);
    ASSERT_TRUE(bench.device->stop());
    bench.begin_segment();
    bench.start(1500);
    EXPECT_TRUE(bench.reads_right(1500));
  }
}

TEST(FsPlusFaults, OverrunWithSmallPackets_LargeOnesAfterwards) {
  FsPlusEmulator unit = faulty_1608();
  Bench bench("mcc:1608fs-plus?channels=0,1,2,3", unit);
  bench.start(100, 2);
  ASSERT_EQ(unit.last_start()[9], 1);
  unit.faults.overrun_at_code = 400;
  ASSERT_EQ(bench.read(3000).last.gap.reason, GapReason::Overrun);
  ASSERT_TRUE(bench.device->stop());
  bench.begin_segment();

  bench.start(100, 2);

  EXPECT_EQ(unit.last_start()[9], 0);
  EXPECT_TRUE(bench.reads_right(500));
}

TEST(FsPlusFaults, HostAwayForThreeSeconds_RealOverrun) {
  FsPlusEmulator unit = faulty_1608();
  Bench bench("mcc:1608fs-plus", unit);
  bench.start(1500);
  ASSERT_TRUE(bench.reads_right(1500));

  bench.clock.advance_ns(3 * kSecond);  // the FIFO holds 2.7 s

  EXPECT_EQ(bench.read(1500).last.gap.reason, GapReason::Overrun);
}

TEST(FsPlusFaults, HostThatStoodStillWhileTheDeviceHeldItsScans_LosesNone) {
  FsPlusEmulator unit = faulty_1608();
  unit.faults.pause_at_code = 8 * 500;
  unit.faults.pause_ns = 1600 * kMillisecond;
  Bench bench("mcc:1608fs-plus", unit);
  bench.start(500, 8);
  ASSERT_TRUE(bench.reads_right(496));
  bench.bus.run_until(bench.clock.now_ns() + 50 * kMillisecond);

  bench.clock.advance_ns(1500 * kMillisecond);  // the machine stood still, and the device has all of it

  const Reading reading = bench.read(4000);
  EXPECT_GE(reading.scans, 4000U) << name(reading.last.gap.reason);
  EXPECT_EQ(reading.wrong, 0U);
}

TEST(FsPlusFaults, AnotherProductOfTheMakerIsPluggedIn_Named) {
  FsPlusEmulator other(FsPlusKind::Usb1208, "01AB", moving_source());
  Bench bench("mcc:1608fs-plus", other);

  const auto opened = bench.device->open();

  ASSERT_FALSE(opened.has_value());
  EXPECT_EQ(opened.error().code, core::ErrorCode::NotFound);
  EXPECT_EQ(opened.error().hint, "plugged in: USB-1208FS-Plus 01AB: write mcc:1208fs-plus?serial=01AB");
}

TEST(FsPlusFaults, ImpossibleCodeOfA12BitUnit_Integrity) {
  FsPlusEmulator unit(FsPlusKind::Usb1208, "01A2B3C4", moving_source());
  Bench bench("mcc:1208fs-plus", unit);
  bench.start(1000);
  unit.faults.corrupt_at_code = 9'999;

  EXPECT_EQ(bench.read(6000).last.gap.reason, GapReason::Integrity);
}

TEST(FsPlusFaults, LostSampleLater_MarkerFindsItAtOnce) {
  FsPlusEmulator unit(FsPlusKind::Usb1608, "01A2B3C4", [](double time_s, std::span<double> volts) {
    moving_source()(time_s, volts);
    volts[7] = 3.0;
  });
  Bench bench("mcc:1608fs-plus?marker=7&marker_v=3", unit);
  bench.start(1500);
  unit.faults.drop_code_at = 8 * 2000 + 4;

  core::Block block(8, 64);
  std::uint64_t scans = 0;
  ReadResult last = bench.device->read(block, bench.clock.now_ns() + kSecond);
  for (; last.outcome == ReadOutcome::Scans && scans < 5000; last = bench.device->read(block, bench.clock.now_ns() + kSecond)) {
    scans += block.count();
  }

  EXPECT_EQ(scans, 2000U);  // not one rotated scan
  EXPECT_EQ(last.gap.reason, GapReason::Integrity);
}

TEST(FsPlusFaults, FaultOrReplugAfterTheTrigger_GoesOnWithoutIt) {
  FsPlusEmulator unit = faulty_1608();
  Bench bench("mcc:1608fs-plus?trigger=rising", unit);
  bench.start(1500);
  core::Block block(8, 64);
  ASSERT_EQ(bench.device->read(block, bench.clock.now_ns() + kSecond).outcome, ReadOutcome::Armed);
  ASSERT_TRUE(bench.device->stop());
  bench.start(1500);
  ASSERT_TRUE(unit.is_armed()) << "stopped before the trigger";

  unit.fire_trigger(bench.clock.now_ns());
  unit.faults.overrun_at_code = 20'000;
  ASSERT_EQ(bench.read(6000).last.gap.reason, GapReason::Overrun);
  ASSERT_TRUE(bench.device->stop());
  bench.begin_segment();
  bench.start(1500);
  EXPECT_FALSE(unit.is_armed());
  EXPECT_TRUE(bench.reads_right(1500));

  bench.bus.unplug(unit);
  ASSERT_EQ(bench.read(3000).last.outcome, ReadOutcome::Gone);
  ASSERT_TRUE(bench.device->close());
  bench.bus.plug(unit);
  bench.begin_segment();
  bench.start(1500);

  EXPECT_FALSE(unit.is_armed());
  EXPECT_TRUE(bench.reads_right(1500));
}

TEST(FsPlusFaults, VoltagesMoveBeforeTheTrigger_NoAlarm) {
  std::size_t shift = 0;
  FsPlusEmulator unit(FsPlusKind::Usb1608, "01A2B3C4", [&shift](double, std::span<double> volts) {
    for (std::size_t input = 0; input < volts.size(); ++input) volts[input] = 0.5 * static_cast<double>((input + shift) % 8);
  });
  Bench bench("mcc:1608fs-plus?trigger=rising", unit);
  bench.start(1500);

  shift = 1;  // as if the channels were rotated
  unit.fire_trigger(bench.clock.now_ns());

  EXPECT_EQ(bench.read(1500).last.outcome, ReadOutcome::Scans);
  const std::vector<DeviceCheck> checks = bench.device->report().checks;
  EXPECT_TRUE(
      std::any_of(checks.begin(), checks.end(), [](const DeviceCheck& check) { return check.outcome == DeviceCheck::Outcome::Skipped; }));
}

TEST(FsPlusFaults, StopRequestLost_StopSaysSo) {
  FsPlusEmulator unit = faulty_1608();
  Bench bench("mcc:1608fs-plus", unit);
  bench.start(1500);
  ASSERT_TRUE(bench.reads_right(300));
  unit.faults.silent_control_requests = 1;

  const auto stopped = bench.device->stop();

  ASSERT_FALSE(stopped.has_value());
  EXPECT_EQ(stopped.error().code, core::ErrorCode::Timeout);
  EXPECT_EQ(bench.device->state(), DeviceState::Open);
  bench.begin_segment();
  bench.start(1500);
  EXPECT_TRUE(bench.reads_right(3000));
}

TEST(FsPlusFaults, DeviceAtTwiceItsRate_Integrity) {
  FsPlusEmulator unit = faulty_1608();
  unit.faults.rate_factor = 2.0;
  Bench bench("mcc:1608fs-plus", unit);
  bench.start(1500);

  EXPECT_EQ(bench.read(30'000).last.gap.reason, GapReason::Integrity);
}

}  // namespace
}  // namespace dts::device::mcc
