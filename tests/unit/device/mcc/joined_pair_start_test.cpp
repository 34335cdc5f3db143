// SPDX-License-Identifier: Apache-2.0
// How a pair starts: the second unit must hear the first pulse of the scan, and none before it.
#include <gtest/gtest.h>

#include <algorithm>

#include "device/mcc/fs_plus.h"
#include "device/mcc/joined_pair.h"
#include "device/usb/usb_daq.h"
#include "unit/device/mcc/pair_bench.h"

namespace dts::device::mcc {
namespace {

using core::GapReason;
using test::kPairUri;
using test::kSecond;
using test::PairBench;
using test::Reading;
using test::Wired;

TEST(JoinedPairStart, MasterWaitsForItsTriggerAndAFaultAfterItGoesOnWithoutIt) {
  Wired units;
  PairBench bench(units, "&trigger=high");
  bench.start(1500);
  core::Block block(16, 64);
  EXPECT_EQ(bench.device->read(block, bench.clock.now_ns() + 2 * kSecond).outcome, ReadOutcome::Armed);
  units.first.fire_trigger(bench.clock.now_ns());
  EXPECT_TRUE(bench.reads_right(1500));
  units.second.faults.overrun_at_code = 20'000;
  ASSERT_EQ(bench.read(30'000).last.gap.reason, GapReason::Overrun);
  ASSERT_TRUE(bench.device->stop());
  bench.begin_segment();

  bench.start(1500);

  EXPECT_FALSE(units.first.is_armed());
  EXPECT_TRUE(bench.reads_right(3000));
}

TEST(JoinedPairStart, StopRequestLost_TheNextScanIsAligned) {
  for (const int lost : {1, 2}) {  // 2: its repetition as well, both units are opened again
    Wired units;
    PairBench bench(units);
    bench.start(1500);
    ASSERT_TRUE(bench.reads_right(3000));
    units.first.faults.silent_control_requests = lost;

    EXPECT_FALSE(bench.device->stop().has_value());
    EXPECT_EQ(bench.device->state(), DeviceState::Open);
    ASSERT_TRUE(units.first.is_scanning());
    bench.begin_segment();
    bench.start(1500);

    EXPECT_TRUE(bench.reads_right(15 * 1500)) << lost;
  }
}

TEST(JoinedPairStart, MasterCannotBeStopped_NoStart) {
  Wired units;
  PairBench bench(units);
  bench.start(1500);
  ASSERT_TRUE(bench.reads_right(300));
  units.first.faults.is_mute = true;
  EXPECT_FALSE(bench.device->stop().has_value());

  const auto started = bench.device->start({bench.rate, 64});

  ASSERT_FALSE(started.has_value());
  EXPECT_NE(started.error().what.find("first unit"), std::string::npos) << started.error().what;
  EXPECT_TRUE(bench.device->close());
  units.first.faults.is_mute = false;
  bench.begin_segment();
  bench.start(1500);
  EXPECT_TRUE(bench.reads_right(3000));
}

/// That these tests can see it: here the unit that drives SYNC starts before the one that listens.
TEST(JoinedPairStart, WrongOrderOfStarts_ShowsAsWrongValues) {
  Wired units;
  PairBench bench(units);
  const auto unit = [&bench](const char* serial, SyncPin pin) {
    const usb::DaqOptions options{
        .uri = kPairUri, .serial = serial, .channels = {0, 1, 2, 3, 4, 5, 6, 7}, .ranges_v = std::vector<double>(8, 5.0), .marker = {}};
    FsPlusSettings settings{.options = options, .sync = pin, .sync_output_bit = {}};
    return std::make_unique<usb::UsbDaq>(std::make_unique<FsPlus>(usb_1608fs_plus(), std::move(settings)), options, bench.bus, bench.clock);
  };
  PairParts swapped{.master = unit("BBBB0002", SyncPin::Input),
                    .slave = unit("AAAA0001", SyncPin::Output),
                    .confirm_master_stopped = [] { return core::Status{}; },
                    .description = bench.device->describe()};
  std::rotate(swapped.description.channels.begin(), swapped.description.channels.begin() + 8, swapped.description.channels.end());
  bench.device = std::make_unique<JoinedPair>(std::move(swapped), bench.clock);
  bench.start(1500);

  const Reading reading = bench.read(1500);

  EXPECT_GT(reading.scans, 0U);
  EXPECT_GT(reading.wrong, 0U);
}

}  // namespace
}  // namespace dts::device::mcc
