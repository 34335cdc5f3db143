// SPDX-License-Identifier: Apache-2.0
// The cable: pulled out at any moment, refused transfers, harm at every request, a host controller that gives nothing back.
#include <gtest/gtest.h>

#include <string>

#include "device/usb/usb_daq.h"
#include "unit/device/usb/toy_bench.h"

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace dts::device::usb {
namespace {

using core::ErrorCode;
using core::GapReason;
using test::kMillisecond;
using test::kSecond;
using test::ToyBench;

constexpr std::int64_t kUnplugFoundWithinNs = 250 * kMillisecond;

TEST(UsbDaqCable, Unplugged_ScansBeforeItThenGone) {
  ToyBench bench;
  bench.run(1500, 64);
  ASSERT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);
  bench.host.bus.run_until(bench.host.clock.now_ns() + 500 * kMillisecond);
  const std::uint64_t before = bench.checker->scans();

  bench.host.bus.unplug(bench.device);
  const std::int64_t unplugged_ns = bench.host.clock.now_ns();
  const ReadResult result = bench.read_until_trouble(kSecond);

  EXPECT_EQ(result.outcome, ReadOutcome::Gone);
  EXPECT_EQ(result.gap.reason, GapReason::Unplugged);
  EXPECT_NEAR(static_cast<double>(bench.checker->scans() - before), 750, 16);
  EXPECT_LE(bench.host.clock.now_ns(), unplugged_ns + kUnplugFoundWithinNs);
  EXPECT_EQ(bench.checker->wrong(), 0U);
  EXPECT_EQ(bench.daq->state(), DeviceState::Gone);
}

TEST(UsbDaqCable, SubmitRefusedWhileStreaming_Gone) {
  ToyBench bench;
  bench.run(1500);
  ASSERT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);

  bench.host.bus.refuses_submit = true;

  EXPECT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Gone);
}

TEST(UsbDaqCable, SubmitRefusedAtEveryPointOfAStart_GoneAndNothingLeft) {
  for (std::uint64_t accepted = 0; accepted < 8; ++accepted) {
    ToyBench bench;
    ASSERT_TRUE(bench.daq->open().has_value());
    bench.host.bus.submits_until_refusal = accepted;

    const auto started = bench.start(1500);

    ASSERT_FALSE(started.has_value()) << accepted;
    EXPECT_EQ(started.error().code, ErrorCode::DeviceGone);
    EXPECT_EQ(bench.daq->state(), DeviceState::Gone);
    EXPECT_EQ(bench.host.bus.transfers_in_flight(), 0) << accepted;
  }
}

TEST(UsbDaqCable, UnplugAndReplugOrLeavingByItself_EveryScanRightNothingLeft) {
  ToyBench bench({.serial = "T1"});
  for (int cycle = 0; cycle < 6; ++cycle) {
    bench.run(1500);
    EXPECT_EQ(bench.read_until_trouble((50 + 27 * cycle) * kMillisecond).outcome, ReadOutcome::Timeout);
    const bool leaves_by_itself = cycle == 5;
    if (leaves_by_itself) bench.device.wants_out = true;
    if (!leaves_by_itself) bench.host.bus.unplug(bench.device);
    EXPECT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Gone);
    EXPECT_EQ(bench.checker->wrong(), 0U);
    EXPECT_TRUE(bench.daq->stop().has_value());
    EXPECT_TRUE(bench.daq->close().has_value());
    EXPECT_EQ(bench.host.bus.open_ports(), 0);
    EXPECT_EQ(bench.host.bus.transfers_in_flight(), 0);
    const core::Status opened = bench.daq->open();
    ASSERT_FALSE(opened.has_value());
    EXPECT_EQ(opened.error().code, ErrorCode::NotFound);
    (void)bench.daq->has_arrived();
    EXPECT_FALSE(bench.daq->has_arrived());
    if (leaves_by_itself) bench.host.clock.advance_ns(kSecond);
    if (!leaves_by_itself) bench.host.bus.plug(bench.device);
    EXPECT_TRUE(bench.daq->has_arrived());
  }
  bench.run(1500);
  EXPECT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);
}

TEST(UsbDaqCable, CancelThatNeverReturns_MemoryIsGivenUpAndSaidSo) {
#ifdef __SANITIZE_ADDRESS__
  const __lsan::ScopedDisabler leaks_on_purpose;
#endif
  ToyBench bench;
  bench.host.may_leak = true;
  bench.run(1500);
  ASSERT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);
  bench.host.bus.swallows_cancel = true;
  const std::int64_t before_ns = bench.host.clock.now_ns();

  const core::Status stopped = bench.daq->stop();

  ASSERT_FALSE(stopped.has_value());
  EXPECT_NE(stopped.error().what.find("did not end"), std::string::npos);
  EXPECT_LE(bench.host.clock.now_ns(), before_ns + 250 * kMillisecond);
  EXPECT_EQ(bench.host.bus.open_ports(), 1);
  EXPECT_EQ(bench.daq->state(), DeviceState::Gone);
  const DeviceCheck check = bench.daq->report().checks.back();
  EXPECT_EQ(check.outcome, DeviceCheck::Outcome::Failed);
  EXPECT_TRUE(bench.daq->close().has_value());
  // Plugged in again it is another unit for the bus.
  bench.host.bus.swallows_cancel = false;
  bench.host.bus.unplug(bench.device);
  bench.host.bus.plug(bench.device);
  bench.run(1500);
  EXPECT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);
}

TEST(UsbDaqCable, CancelThatReturnsLate_OpenAndStartSayBothAndSucceedAfterIt) {
  ToyBench bench;
  bench.run(1500);
  ASSERT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);
  bench.host.bus.cancel_ns = kSecond;

  EXPECT_FALSE(bench.daq->stop().has_value());
  EXPECT_TRUE(bench.daq->close().has_value());
  const core::Status early = bench.daq->open();
  bench.host.bus.run_until(bench.host.clock.now_ns() + 2 * kSecond);

  ASSERT_FALSE(early.has_value());
  EXPECT_NE(early.error().what.find("have not ended yet"), std::string::npos) << early.error().what;
  EXPECT_NE(early.error().hint.find("unplug"), std::string::npos);

  ASSERT_TRUE(bench.daq->open().has_value());
  bench.device.takes_begin_without_running = true;
  const auto started = bench.start(1500);
  ASSERT_FALSE(started.has_value());
  EXPECT_NE(started.error().what.find("does not scan"), std::string::npos) << started.error().what;
  EXPECT_NE(started.error().what.find("did not end"), std::string::npos) << started.error().what;
  EXPECT_EQ(bench.daq->state(), DeviceState::Gone);
  bench.host.bus.run_until(bench.host.clock.now_ns() + 2 * kSecond);
  bench.host.bus.cancel_ns = 0;
  bench.device.takes_begin_without_running = false;
  EXPECT_TRUE(bench.daq->close().has_value());
  bench.run(1500);
  EXPECT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);
  EXPECT_EQ(bench.checker->wrong(), 0U);
  EXPECT_EQ(bench.host.bus.open_ports(), 1);
}

}  // namespace
}  // namespace dts::device::usb
