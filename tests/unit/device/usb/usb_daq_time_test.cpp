// SPDX-License-Identifier: Apache-2.0
// The device's crystal, the host's crystal and the wall clock that pulls at the host's time: which may do what to a stream.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "device/usb/usb_daq.h"

#include "unit/device/usb/toy_bench.h"

namespace dts::device::usb {
namespace {

using test::kMillisecond;
using test::kSecond;
using test::ToyBench;

/// By how much the newest block's time is wrong now.
std::int64_t time_error_ns(ToyBench& bench) {
  const core::Block& block = bench.checker->block();
  const std::int64_t truth_ns = core::monotonic_of_raw_ns(bench.host.clock, bench.device.instant_ns(block.first_scan.value));
  return std::abs(block.host_time_ns - truth_ns);
}

/// Reads for so long; `each` is called behind every block. The first outcome that is neither scans nor nothing.
ReadOutcome read_for(ToyBench& bench, std::int64_t for_ns, const std::function<void()>& each) {
  const std::int64_t until_ns = bench.host.clock.raw_ns() + for_ns;
  while (bench.host.clock.raw_ns() < until_ns) {
    const ReadOutcome outcome = bench.checker->read(bench.host.clock.now_ns() + 50 * kMillisecond).outcome;
    if (outcome != ReadOutcome::Scans && outcome != ReadOutcome::Timeout) return outcome;
    if (outcome == ReadOutcome::Scans) each();
  }
  return ReadOutcome::Timeout;
}

DeviceCheck check_named(const UsbDaq& daq, const std::string& name) {
  for (const DeviceCheck& check : daq.report().checks) {
    if (check.name == name) return check;
  }
  return {"not there: " + name, DeviceCheck::Outcome::Failed, ""};
}

TEST(UsbDaqTime, WallClockSlewedBy300Milliseconds_NoBreakAndTimesFollow) {
  RecordProperty("requirement", "ACQ-10");
  for (const std::int64_t sign : {1, -1}) {
    ToyBench bench;
    bench.run(1500, 15);
    ASSERT_EQ(read_for(bench, 30 * kSecond, [] {}), ReadOutcome::Timeout);
    std::int64_t slewed_ns = 0;
    std::int64_t last_ns = 0;

    const ReadOutcome outcome = read_for(bench, 60 * kSecond, [&] {
      EXPECT_LE(time_error_ns(bench), bench.checker->block().host_time_uncertainty_ns + kMillisecond / 2);
      EXPECT_GT(bench.checker->block().host_time_ns, last_ns);
      last_ns = bench.checker->block().host_time_ns;
      if (slewed_ns == 300 * kMillisecond) return;
      bench.host.clock.slew_ns(sign * kMillisecond / 2);  // 5 % for six seconds, as chrony may
      slewed_ns += kMillisecond / 2;
    });

    EXPECT_EQ(outcome, ReadOutcome::Timeout) << sign;
    EXPECT_EQ(slewed_ns, 300 * kMillisecond);
    EXPECT_EQ(bench.checker->wrong(), 0U);
    EXPECT_NEAR(bench.checker->block().clock_drift_ppm, 0.0, 5.0);
    EXPECT_EQ(check_named(*bench.daq, "no scans are missing on the way").outcome, DeviceCheck::Outcome::Passed);
  }
}

TEST(UsbDaqTime, WallClockSlewedAgainstALateReader_TimeNeverGoesBack) {
  ToyBench bench;
  bench.run(1500, 15);
  ASSERT_EQ(read_for(bench, 5 * kSecond, [] {}), ReadOutcome::Timeout);
  bench.host.bus.run_until(bench.host.clock.now_ns() + kSecond);
  ASSERT_EQ(bench.checker->read(0).outcome, ReadOutcome::Scans);
  std::int64_t last_ns = bench.checker->block().host_time_ns;

  bench.host.clock.slew_ns(-100 * kMillisecond);

  EXPECT_EQ(read_for(bench, kSecond,
                     [&] {
                       EXPECT_GT(bench.checker->block().host_time_ns, last_ns);
                       last_ns = bench.checker->block().host_time_ns;
                     }),
            ReadOutcome::Timeout);
}

TEST(UsbDaqTime, ClockFasterThanAnyCrystal_UnbrokenDriftPublishedAndWarnedOf) {
  ToyBench bench;
  bench.device.faults.clock_error_ppm = 2000.0;
  bench.run(1500, 15);

  ASSERT_EQ(read_for(bench, 60 * kSecond, [] {}), ReadOutcome::Timeout);

  EXPECT_EQ(bench.checker->wrong(), 0U);
  EXPECT_NEAR(bench.checker->block().clock_drift_ppm, 2000.0, 10.0);
  EXPECT_LE(time_error_ns(bench), kMillisecond);
  const DeviceCheck check = check_named(*bench.daq, "the scan runs at its rate");
  EXPECT_EQ(check.outcome, DeviceCheck::Outcome::Warning);
  EXPECT_NE(check.detail.find("more than any crystal oscillator"), std::string::npos);
  EXPECT_NE(check.detail.find("fast"), std::string::npos);
}

TEST(UsbDaqTime, FirstSeconds_AreNotSaidToHavePassed) {
  ToyBench bench;
  bench.run(1500, 15);

  ASSERT_EQ(read_for(bench, kSecond, [] {}), ReadOutcome::Timeout);
  EXPECT_EQ(check_named(*bench.daq, "the scan runs at its rate").outcome, DeviceCheck::Outcome::Skipped);
  EXPECT_EQ(check_named(*bench.daq, "no scans are missing on the way").outcome, DeviceCheck::Outcome::Skipped);

  ASSERT_EQ(read_for(bench, 3 * kSecond, [] {}), ReadOutcome::Timeout);
  EXPECT_EQ(check_named(*bench.daq, "the scan runs at its rate").outcome, DeviceCheck::Outcome::Passed);
  EXPECT_EQ(check_named(*bench.daq, "no scans are missing on the way").outcome, DeviceCheck::Outcome::Passed);
}

TEST(UsbDaqTime, ClockSlowerThanAnyCrystal_CannotBeToldFromLostScansAndIsNotBelieved) {
  ToyBench bench;
  bench.device.faults.clock_error_ppm = -2000.0;
  bench.run(1500, 15);

  EXPECT_EQ(read_for(bench, 6 * kSecond, [] {}), ReadOutcome::Broken);

  const DeviceCheck check = check_named(*bench.daq, "no scans are missing on the way");
  EXPECT_EQ(check.outcome, DeviceCheck::Outcome::Failed);
  EXPECT_NE(check.detail.find("a device clock that is far too slow"), std::string::npos);
}

TEST(UsbDaqTime, EventThreadStalledAtTheStart_TimeErrorWithinItsUncertainty) {
  for (const std::int64_t stall_ns : {0 * kMillisecond, 20 * kMillisecond, 150 * kMillisecond}) {
    for (const double rate_hz : {100.0, 1500.0}) {
      ToyBench bench;
      ASSERT_TRUE(bench.daq->open().has_value());
      std::int64_t stalled_until_ns = -1;
      bench.host.bus.lateness_ns = [&] {
        if (stalled_until_ns < 0) stalled_until_ns = bench.device.instant_ns(0) + stall_ns;
        return stalled_until_ns - bench.host.clock.now_ns();
      };
      ASSERT_TRUE(bench.start(rate_hz, 15).has_value());
      std::int64_t first_uncertainty_ns = 0;

      const ReadOutcome outcome = read_for(bench, 20 * kSecond, [&] {
        const std::int64_t uncertainty_ns = bench.checker->block().host_time_uncertainty_ns;
        if (first_uncertainty_ns == 0) first_uncertainty_ns = uncertainty_ns;
        ASSERT_LE(time_error_ns(bench), uncertainty_ns) << stall_ns << " at " << rate_hz;
      });

      EXPECT_EQ(outcome, ReadOutcome::Timeout);
      EXPECT_LT(first_uncertainty_ns, std::max(stall_ns, 10 * kMillisecond) + 30 * kMillisecond) << "by the request, not by a guess";
    }
  }
}

TEST(UsbDaqTime, Triggered_FirstSecondsAreNotSaidToBeCertain) {
  ToyBench bench({.driver = {.has_single_readings = false, .waits_for_trigger = true}});
  bench.run(100, 5);
  EXPECT_EQ(bench.checker->read(bench.host.clock.now_ns() + kSecond).outcome, ReadOutcome::Armed);
  bench.device.trigger(bench.host.clock.now_ns());

  ASSERT_EQ(bench.checker->read(bench.host.clock.now_ns() + kSecond).outcome, ReadOutcome::Scans);

  EXPECT_GE(bench.checker->block().host_time_uncertainty_ns, 100 * kMillisecond);
  EXPECT_LT(bench.checker->block().host_time_uncertainty_ns, 200 * kMillisecond) << "the second before the trigger says nothing";
}

}  // namespace
}  // namespace dts::device::usb
