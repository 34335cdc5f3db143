// SPDX-License-Identifier: Apache-2.0
// How a simulated device behaves in time: pacing, late readers, faults. What every device must do is in
// tests/contract/device_contract_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "unit/device/sim_rig.h"

namespace dts::device {
namespace {

using test::Bench;
using test::kNoDeadline;
using test::Recorded;

constexpr std::int64_t kMillisecond = core::kNanosecondsPerMillisecond;
constexpr std::int64_t kSimulatedSecond = 1000 * kMillisecond;

TEST(SimDevice, ClockThatIsOff_IsSaidInEveryBlockAndDataStay) {
  Bench exact("sim:floor");
  Bench fast("sim:floor?clock_ppm=200");
  exact.start(100);
  fast.start(100);

  const Recorded from_exact = exact.read_scans(1001, 1);
  const Recorded from_fast = fast.read_scans(1001, 1);

  EXPECT_EQ(from_exact.block_times_ns[1000] - from_exact.block_times_ns[0], 10 * kSimulatedSecond);
  EXPECT_EQ(from_fast.block_times_ns[1000] - from_fast.block_times_ns[0], 10 * kSimulatedSecond - 2 * kMillisecond);
  EXPECT_EQ(from_exact.channels[0], from_fast.channels[0]);
  core::Block block = fast.block(8);
  ASSERT_EQ(fast.device->read(block, kNoDeadline).outcome, ReadOutcome::Scans);
  EXPECT_EQ(block.clock_drift_ppm, 200.0);
  EXPECT_EQ(block.host_time_uncertainty_ns, 0);
}

TEST(SimDevice, FullBlock_TakesAsLongAsItsScansUnlessTheDeadlineIsFirst) {
  Bench bench("sim:floor");
  bench.start(100);
  core::Block block = bench.block(50);
  const std::int64_t start_ns = bench.clock.now_ns();

  EXPECT_EQ(bench.device->read(block, kNoDeadline).outcome, ReadOutcome::Scans);
  EXPECT_EQ(block.count(), 50U);
  EXPECT_EQ(block.host_time_ns, start_ns);
  EXPECT_EQ(bench.clock.now_ns(), start_ns + 490 * kMillisecond);
  EXPECT_EQ(bench.device->read(block, start_ns + 499 * kMillisecond).outcome, ReadOutcome::Timeout);
  EXPECT_EQ(block.count(), 0U);
  EXPECT_EQ(bench.device->read(block, start_ns + 525 * kMillisecond).outcome, ReadOutcome::Scans);
  EXPECT_EQ(block.count(), 3U);  // at 500, 510 and 520 ms
}

TEST(SimDevice, ReaderTooLate_OverrunWithExactCount) {
  Bench bench("sim:floor");
  Bench punctual("sim:floor");
  bench.start(100);
  punctual.start(100);
  bench.clock.advance_ns(3990 * kMillisecond);  // 400 scans are there: exactly the buffer
  const Recorded in_time = bench.read_scans(400, 10);
  EXPECT_TRUE(in_time.gaps.empty());
  EXPECT_EQ(in_time.block_firsts.back(), 390U);
  bench.clock.advance_ns(5 * kSimulatedSecond + 5 * kMillisecond);  // 500 more scans

  const Recorded recorded = bench.read_scans(64);
  const Recorded all = punctual.read_scans(964);

  ASSERT_EQ(recorded.gaps.size(), 1U);
  EXPECT_EQ(recorded.gaps[0].reason, core::GapReason::Overrun);
  EXPECT_EQ(recorded.gaps[0].missing_scans, 500U);
  EXPECT_TRUE(recorded.gaps[0].is_exact);
  EXPECT_EQ(recorded.block_firsts[0], 0U);  // a new segment
  EXPECT_TRUE(std::equal(recorded.channels[0].begin(), recorded.channels[0].end(), all.channels[0].begin() + 900));
}

TEST(SimDevice, FaultOverrun_ExactGapThenTheScansAfterIt) {
  Bench bench("sim:floor?fault=overrun&fault_at_s=1&fault_for_s=0.5");
  Bench healthy("sim:floor");
  bench.start(100);
  healthy.start(100);
  const std::int64_t start_ns = bench.clock.now_ns();

  const Recorded recorded = bench.read_scans(200);
  const Recorded all = healthy.read_scans(250);

  ASSERT_EQ(recorded.gaps.size(), 1U);
  EXPECT_EQ(recorded.gaps[0].reason, core::GapReason::Overrun);
  EXPECT_EQ(recorded.gaps[0].missing_scans, 50U);
  EXPECT_TRUE(recorded.gaps[0].is_exact);
  EXPECT_EQ(recorded.block_firsts, (std::vector<std::uint64_t>{0, 64, 0, 64}));
  EXPECT_EQ(recorded.block_times_ns[2], start_ns + 1500 * kMillisecond);
  EXPECT_TRUE(std::equal(recorded.channels[0].begin(), recorded.channels[0].begin() + 100, all.channels[0].begin()));
  EXPECT_TRUE(std::equal(recorded.channels[0].begin() + 100, recorded.channels[0].end(), all.channels[0].begin() + 150));
}

TEST(SimDevice, FaultSilence_TimeoutsThenAnEstimatedGap) {
  Bench bench("sim:floor?clock_ppm=1000&fault=silence&fault_at_s=1&fault_for_s=20");
  bench.start(100);
  (void)bench.read_scans(100, 10);
  core::Block block = bench.block(10);
  int timeouts = 0;
  ReadResult read = bench.device->read(block, bench.clock.now_ns() + kSimulatedSecond);
  for (; read.outcome == ReadOutcome::Timeout; ++timeouts) read = bench.device->read(block, bench.clock.now_ns() + kSimulatedSecond);

  EXPECT_EQ(timeouts, 19);  // the silence ends during the twentieth second: the device's clock is fast
  EXPECT_EQ(read.outcome, ReadOutcome::Gap);
  EXPECT_EQ(read.gap.reason, core::GapReason::Silence);
  EXPECT_EQ(read.gap.missing_scans, 1998U);  // 2000 scans of a clock that is 0.1 % fast, as the host sees it
  EXPECT_FALSE(read.gap.is_exact);
  ASSERT_EQ(bench.device->read(block, kNoDeadline).outcome, ReadOutcome::Scans);
  EXPECT_EQ(block.first_scan.value, 0U);
}

TEST(SimDevice, FaultUnplug_GoneUntilPluggedInAgain) {
  Bench bench("sim:floor?fault=unplug&fault_at_s=1&fault_for_s=3");
  bench.start(100);
  core::Block block = bench.block(64);

  const Recorded recorded = bench.read_scans(1000);
  EXPECT_EQ(recorded.channels[0].size(), 100U);
  EXPECT_EQ(bench.device->state(), DeviceState::Gone);
  const ReadResult read = bench.device->read(block, kNoDeadline);
  EXPECT_EQ(read.outcome, ReadOutcome::Gone);
  EXPECT_EQ(read.gap.reason, core::GapReason::Unplugged);

  (void)bench.device->close();
  bench.clock.advance_ns(2999 * kMillisecond);
  const core::Status too_early = bench.device->open();
  ASSERT_FALSE(too_early.has_value());
  EXPECT_EQ(too_early.error().code, core::ErrorCode::NotFound);

  bench.clock.advance_ns(kMillisecond);
  bench.start(100);
  EXPECT_EQ(bench.read_scans(300).channels[0].size(), 300U);  // it happens once
}

TEST(SimDevice, FaultAtTheStartOrOfALateReader_EveryLostScanIsCounted) {
  Bench first("sim:floor?fault=overrun&fault_at_s=0&fault_for_s=0.5");
  first.start(100);
  const Recorded at_start = first.read_scans(10);
  ASSERT_EQ(at_start.gaps.size(), 1U);
  EXPECT_EQ(at_start.gaps[0].missing_scans, 50U);

  Bench late("sim:floor?fault=overrun&fault_at_s=6&fault_for_s=1");
  late.start(100);
  late.clock.advance_ns(10'990 * kMillisecond);
  const Recorded recorded = late.read_scans(1);
  ASSERT_EQ(recorded.gaps.size(), 2U);
  EXPECT_EQ(recorded.gaps[0].missing_scans + recorded.gaps[1].missing_scans, 700U);  // 700..1100 fit the buffer
}

TEST(SimDevice, WrongBlockShape_TimeoutAndNothingWritten) {
  Bench bench("sim:floor");
  bench.start(100);
  core::Block no_room;
  core::Block too_few_channels(2, 8);

  EXPECT_EQ(bench.device->read(no_room, kNoDeadline).outcome, ReadOutcome::Timeout);
  EXPECT_EQ(bench.device->read(too_few_channels, kNoDeadline).outcome, ReadOutcome::Timeout);
  EXPECT_EQ(too_few_channels.count(), 0U);
}

}  // namespace
}  // namespace dts::device
