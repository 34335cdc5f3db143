// SPDX-License-Identifier: Apache-2.0
// USB-1608FS-Plus and its relatives as whole devices, over an emulated unit and a virtual clock.
#include "device/mcc/fs_plus.h"

#include <gtest/gtest.h>

#include "unit/device/mcc/mcc_bench.h"
#include "usb/emulator/fs_plus_emulator.h"

namespace dts::device::mcc {
namespace {

using emulator::FsPlusEmulator;
using emulator::FsPlusKind;
using test::Bench;
using test::kMillisecond;
using test::kSecond;
using test::moving_source;

FsPlusEmulator unit_1608() { return {FsPlusKind::Usb1608, "01A2B3C4", moving_source()}; }

TEST(FsPlus, EightChannelsAt1500Hz_EverySampleRight) {
  FsPlusEmulator unit = unit_1608();
  Bench bench("mcc:1608fs-plus?range_v=10,5,2,2,5,10,5,2", unit);  // each has its own calibration record
  bench.start(1500);

  EXPECT_TRUE(bench.reads_right(15'000));
  EXPECT_EQ(bench.rate, *core::Rate::create(40'000'000, 26'667));
  EXPECT_EQ(unit.forbidden_requests, 0);
}

TEST(FsPlus, FourChannelsAt100HzStoppedAndStarted_EverySampleRight) {
  FsPlusEmulator unit = unit_1608();
  Bench bench("mcc:1608fs-plus?channels=0,2,5,7", unit);
  for (int round = 0; round < 3; ++round) {
    bench.begin_segment();
    bench.start(100, 2);
    EXPECT_TRUE(bench.reads_right(777));
    ASSERT_TRUE(bench.device->stop());
  }
  EXPECT_EQ(unit.last_start()[8], 0xA5);
  EXPECT_EQ(unit.last_start()[9], 1);  // immediate
  EXPECT_EQ(bench.bus.transfers_in_flight(), 0);
}

TEST(FsPlus, EachRelative_EverySampleRight) {
  for (const auto& [kind, uri] : {std::pair{FsPlusKind::Usb1208, "mcc:1208fs-plus"},
                                  {FsPlusKind::Usb1408, "mcc:1408fs-plus"},
                                  {FsPlusKind::Usb201, "mcc:usb-201"},
                                  {FsPlusKind::Usb202, "mcc:usb-202"},
                                  {FsPlusKind::Usb204, "mcc:usb-204"},
                                  {FsPlusKind::Usb205, "mcc:usb-205"}}) {
    FsPlusEmulator unit(kind, "01A2B3C4", moving_source());
    unit.failing_starts = kind == FsPlusKind::Usb204 ? 1 : 0;
    Bench bench(uri, unit);
    bench.start(1500);

    EXPECT_TRUE(bench.reads_right(3000, 1.0 / bench.rate.hz() / 8.0)) << uri;
    EXPECT_EQ(unit.forbidden_requests, 0) << uri;
  }
}

TEST(FsPlus, ScanLeftRunningByAnotherProgram_EndsAndLeavesNothingBehind) {
  FsPlusEmulator unit = unit_1608();
  Bench bench("mcc:1608fs-plus", unit);
  const std::vector<std::uint8_t> start = encode_start(StartForm::TenBytes, {.period = 9'999, .mask = 0x07});
  ASSERT_EQ(unit.control({.request_type = 0x40, .request = 0x11, .length = 10}, start, bench.clock.now_ns()).kind,
            emulator::ReplyKind::Done);
  bench.clock.advance_ns(2 * kMillisecond);

  bench.start(1500);

  EXPECT_TRUE(bench.reads_right(3000));
}

TEST(FsPlus, Trigger_ArmedUntilItFires) {
  FsPlusEmulator unit = unit_1608();
  Bench bench("mcc:1608fs-plus?trigger=rising", unit);
  bench.start(1500);
  core::Block block(8, 64);
  ASSERT_TRUE(unit.is_armed());

  EXPECT_EQ(bench.device->read(block, bench.clock.now_ns() + 5 * kSecond).outcome, ReadOutcome::Armed);
  unit.fire_trigger(bench.clock.now_ns());
  EXPECT_TRUE(bench.reads_right(3000));
}

TEST(FsPlus, SyncOutput_DrivesItsLineOnlyAndStandsInTheData) {
  FsPlusEmulator unit = unit_1608();
  unit.loop_back(3, 7);
  Bench bench("mcc:1608fs-plus?sync_output_bit=3&range_v=10", unit);
  bench.start(1500);
  core::Block block(8, 64);
  for (const bool is_high : {false, true, false}) {
    ASSERT_TRUE(bench.device->set_sync_output(is_high));
    EXPECT_EQ(unit.digital_output(3), is_high);
    EXPECT_EQ(unit.digital_output(2), std::nullopt);
    for (int i = 0; i < 10; ++i) ASSERT_EQ(bench.device->read(block, bench.clock.now_ns() + kSecond).outcome, ReadOutcome::Scans);
    EXPECT_NEAR(block.column(7)[63], is_high ? 5.0 : 0.0, 1e-3);
  }
}

TEST(FsPlus, RailCodes_AreMarked) {
  FsPlusEmulator unit(FsPlusKind::Usb1608, "01A2B3C4", [](double, std::span<double> volts) {
    std::fill(volts.begin(), volts.end(), 0.0);
    volts[1] = 7.0;
    volts[2] = -7.0;
  });
  Bench bench("mcc:1608fs-plus?channels=0,1,2", unit);
  bench.start(1000);
  core::Block block(3, 64);

  ASSERT_EQ(bench.device->read(block, bench.clock.now_ns() + kSecond).outcome, ReadOutcome::Scans);

  EXPECT_EQ(block.quality(0)[5], 0);
  EXPECT_EQ(block.quality(1)[5], core::quality::kRail);
  EXPECT_EQ(block.quality(2)[5], core::quality::kRail);
}

}  // namespace
}  // namespace dts::device::mcc
