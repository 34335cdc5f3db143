// SPDX-License-Identifier: Apache-2.0
// Everything that can go wrong with the data of a device, one at a time.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>

#include "device/usb/usb_daq.h"
#include "unit/device/usb/toy_bench.h"

namespace dts::device::usb {
namespace {

using core::ErrorCode;
using core::GapReason;
using emulator::Faults;
using test::kMillisecond;
using test::kSecond;
using test::ToyBench;

constexpr std::int64_t kFoundWithinNs = 250 * kMillisecond;
constexpr std::int64_t kRunningSilenceFoundWithinNs = 800 * kMillisecond;  // of a device that says that it runs

constexpr std::size_t kChannels = 4;

bool has_failed(const UsbDaq& daq, const std::string& name, const std::string& detail = "") {
  const std::vector<DeviceCheck> checks = daq.report().checks;
  return std::any_of(checks.begin(), checks.end(), [&](const DeviceCheck& check) {
    return check.outcome == DeviceCheck::Outcome::Failed && check.name == name && check.detail.find(detail) != std::string::npos;
  });
}

struct Strike {
  const char* name;
  std::uint64_t Faults::*fault;
  GapReason reason;
};

TEST(UsbDaqFaults, EveryStrike_FoundInTimeNothingWrongBeforeItAndTheNextScanIsFine) {
  for (const Strike& strike :
       {Strike{"lost sample", &Faults::drop_code_at, GapReason::Integrity}, Strike{"silence", &Faults::silence_at_code, GapReason::Silence},
        Strike{"stall", &Faults::stall_at_code, GapReason::Stall}, Strike{"overrun", &Faults::overrun_at_code, GapReason::Overrun},
        Strike{"odd short packet", &Faults::short_packet_at_code, GapReason::Integrity},
        Strike{"babble", &Faults::babble_at_code, GapReason::Integrity}}) {
    for (const double rate_hz : {100.0, 1500.0}) {
      SCOPED_TRACE(std::string(strike.name) + " at " + std::to_string(rate_hz));
      ToyBench bench({.driver = {.channels = kChannels}, .has_marker = true});
      const auto strike_scan = static_cast<std::uint64_t>(rate_hz * 0.2);
      bench.device.faults.*strike.fault = strike_scan * kChannels + 1;
      bench.run(rate_hz, 15);
      const std::int64_t found_by_ns =
          bench.device.instant_ns(strike_scan) + (strike.reason == GapReason::Silence ? kRunningSilenceFoundWithinNs : kFoundWithinNs);

      const ReadResult result = bench.read_until_trouble(2 * kSecond);

      EXPECT_EQ(result.outcome, ReadOutcome::Broken);
      EXPECT_EQ(result.gap.reason, strike.reason);
      EXPECT_LE(bench.host.clock.now_ns(), found_by_ns);
      EXPECT_LE(bench.checker->scans(), strike_scan + 8);  // the packet that it strikes in
      EXPECT_EQ(bench.checker->wrong(), 0U);
      EXPECT_EQ(bench.checker->read(0).outcome, ReadOutcome::Broken) << "it is repeated";
      ASSERT_TRUE(bench.daq->stop().has_value());
      ASSERT_TRUE(bench.start(rate_hz).has_value());
      EXPECT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);
      EXPECT_EQ(bench.checker->wrong(), 0U);
    }
  }
}

struct Ending {
  UsbStatus status;
  ReadOutcome outcome;
  GapReason reason;
};

TEST(UsbDaqFaults, EveryStatusAtEveryTransfer_RightWordsNothingWrongNextScanFine) {
  for (const Ending& ending : {Ending{UsbStatus::Stall, ReadOutcome::Broken, GapReason::Stall},
                               Ending{UsbStatus::NoDevice, ReadOutcome::Gone, GapReason::Unplugged},
                               Ending{UsbStatus::Overflow, ReadOutcome::Broken, GapReason::Integrity},
                               Ending{UsbStatus::TimedOut, ReadOutcome::Broken, GapReason::Silence},
                               Ending{UsbStatus::Cancelled, ReadOutcome::Broken, GapReason::Silence},
                               Ending{UsbStatus::Failed, ReadOutcome::Broken, GapReason::Integrity}}) {
    for (std::uint64_t at = 0; at < 30; ++at) {
      ToyBench bench;
      bench.host.bus.completion_status = [&](std::uint64_t number, UsbStatus status) { return number == at ? ending.status : status; };
      bench.run(1500);

      const ReadResult result = bench.read_until_trouble(2 * kSecond);

      EXPECT_EQ(result.outcome, ending.outcome) << to_string(ending.status) << " at " << at;
      EXPECT_EQ(result.gap.reason, ending.reason) << to_string(ending.status) << " at " << at;
      EXPECT_EQ(bench.checker->wrong(), 0U);
      bench.host.bus.completion_status = nullptr;
      EXPECT_TRUE(bench.daq->close().has_value());
      bench.run(1500);
      EXPECT_EQ(bench.read_until_trouble(300 * kMillisecond).outcome, ReadOutcome::Timeout);
      EXPECT_EQ(bench.checker->wrong(), 0U);
    }
  }
}

TEST(UsbDaqFaults, LostSampleInEveryPosition_FoundInTheScanWhereItHappened) {
  constexpr std::size_t kEight = 8;
  for (std::size_t position = 0; position < kEight; ++position) {
    ToyBench bench({.driver = {.channels = kEight}, .has_marker = true});
    bench.device.faults.drop_code_at = 600 * kEight + position;
    bench.run(1500, 15);

    const ReadResult result = bench.read_until_trouble(2 * kSecond);

    EXPECT_EQ(result.outcome, ReadOutcome::Broken);
    EXPECT_EQ(result.gap.reason, GapReason::Integrity);
    EXPECT_EQ(bench.checker->scans(), 600U) << position;
    EXPECT_EQ(bench.checker->wrong(), 0U) << position;
  }
}

TEST(UsbDaqFaults, RotatedFromTheStart_NothingDelivered) {
  RecordProperty("requirement", "ACQ-6");
  for (std::size_t rotation = 1; rotation < kChannels; ++rotation) {
    for (const bool has_marker : {false, true}) {
      ToyBench bench({.driver = {.channels = kChannels}, .has_marker = has_marker});
      bench.device.rotated_by = rotation;
      bench.run(1500, 15);

      const ReadResult result = bench.read_until_trouble(kSecond);

      EXPECT_EQ(result.outcome, ReadOutcome::Broken) << rotation;
      EXPECT_EQ(result.gap.reason, GapReason::Integrity);
      EXPECT_EQ(bench.checker->scans(), 0U);
      EXPECT_TRUE(bench.daq->stop().has_value());
      EXPECT_TRUE(has_failed(*bench.daq, "single readings agree with the scan", "rotated by"));
    }
  }
}

TEST(UsbDaqFaults, SomebodyMovesDuringTheStart_WarningOnly) {
  ToyBench bench;
  bench.device.moved_v = 0.9;
  bench.run(1500);

  EXPECT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);

  EXPECT_GT(bench.checker->scans(), 1000U);
  const auto checks = bench.daq->report().checks;
  EXPECT_TRUE(std::ranges::any_of(checks, [](const DeviceCheck& check) { return check.outcome == DeviceCheck::Outcome::Warning; }));
}

TEST(UsbDaqFaults, WrongRate_FoundInSeconds) {
  RecordProperty("requirement", "ACQ-8");
  for (const double factor : {0.97, 1.03}) {
    ToyBench bench;
    bench.device.faults.rate_factor = factor;
    bench.run(1500);

    const ReadResult result = bench.read_until_trouble(20 * kSecond);

    EXPECT_EQ(result.outcome, ReadOutcome::Broken) << factor;
    EXPECT_EQ(result.gap.reason, GapReason::Integrity);
    EXPECT_LE(bench.host.clock.now_ns(), bench.device.instant_ns(0) + 5 * kSecond);
  }
}

TEST(UsbDaqFaults, LostPacketWithoutMarker_FoundByLatenessInSeconds) {
  ToyBench bench({.driver = {.channels = 1}});  // 32 scans in a packet
  bench.device.faults.drop_packet_at_code = 15'000;
  bench.run(1500);

  const ReadResult result = bench.read_until_trouble(60 * kSecond);

  EXPECT_EQ(result.outcome, ReadOutcome::Broken);
  EXPECT_EQ(result.gap.reason, GapReason::Integrity);
  EXPECT_LE(bench.host.clock.now_ns(), bench.device.instant_ns(15'000) + 5 * kSecond);
  EXPECT_TRUE(has_failed(*bench.daq, "no scans are missing on the way"));
}

TEST(UsbDaqFaults, Break_ItsChecksStayInTheReportUntilClose) {
  ToyBench bench({.driver = {.channels = kChannels}, .has_marker = true});
  bench.device.faults.drop_code_at = 600 * kChannels;
  bench.run(1500, 15);
  ASSERT_EQ(bench.read_until_trouble(2 * kSecond).outcome, ReadOutcome::Broken);
  ASSERT_TRUE(bench.daq->stop().has_value());

  for (int restart = 0; restart < 2; ++restart) {  // the second follows a scan that ended well
    ASSERT_TRUE(bench.start(1500).has_value());
    ASSERT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);
    EXPECT_TRUE(has_failed(*bench.daq, "last break: the marker is last in every scan"));
    EXPECT_TRUE(has_failed(*bench.daq, "last break: the stream is whole", "integrity"));
    EXPECT_FALSE(has_failed(*bench.daq, "the marker is last in every scan")) << "that is of this scan";
    ASSERT_TRUE(bench.daq->stop().has_value());
  }
  ASSERT_TRUE(bench.daq->close().has_value());
  EXPECT_FALSE(has_failed(*bench.daq, "last break: the stream is whole"));
  ASSERT_TRUE(bench.daq->open().has_value());
  EXPECT_FALSE(std::ranges::any_of(bench.daq->report().checks, [](const DeviceCheck& check) {
    return check.name == "single readings agree with the scan";
  })) << "that was of the scan before it was closed";
}

TEST(UsbDaqFaults, TransfersThatFail_AreCountedInTheReport) {
  const auto said = [](const UsbDaq& daq) {
    for (const DeviceCheck& check : daq.report().checks) {
      if (check.name == "USB transfers since dtsd started") return check.detail;
    }
    return std::string();
  };
  ToyBench bench;
  EXPECT_EQ(said(*bench.daq), "") << "never opened";
  bench.run(1500);
  ASSERT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);
  EXPECT_EQ(said(*bench.daq), "no errors");

  for (const UsbStatus status : {UsbStatus::Failed, UsbStatus::Failed, UsbStatus::Stall}) {
    bool is_due = true;
    bench.host.bus.completion_status = [&](std::uint64_t, UsbStatus) {
      return std::exchange(is_due, false) ? status : UsbStatus::Completed;
    };
    ASSERT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Broken);
    bench.host.bus.completion_status = nullptr;
    ASSERT_TRUE(bench.daq->stop().has_value());
    ASSERT_TRUE(bench.start(1500).has_value());
  }

  EXPECT_EQ(said(*bench.daq), "1 x device rejected it (stall); 2 x transfer failed on the bus (cable, hub or host controller)");
}

TEST(UsbDaqFaults, OverrunWithoutStall_FoundByAsking) {
  ToyBench bench;
  bench.device.stalls_on_overrun = false;
  bench.device.faults.overrun_at_code = 4 * 500;
  bench.run(1500);

  const ReadResult result = bench.read_until_trouble(2 * kSecond);

  EXPECT_EQ(result.gap.reason, GapReason::Overrun);
  EXPECT_LE(bench.host.clock.now_ns(), bench.device.instant_ns(500) + kFoundWithinNs);
  EXPECT_EQ(bench.checker->wrong(), 0U);
}

TEST(UsbDaqFaults, HostSuspendedOrReaderAwayForTooLong_Overrun) {
  for (const bool is_suspended : {true, false}) {  // the device's buffer overruns, or ours
    ToyBench bench({.driver = {.buffer_chunks = 64}});
    bench.run(1500);
    ASSERT_EQ(bench.read_until_trouble(kSecond).outcome, ReadOutcome::Timeout);

    if (is_suspended) bench.host.clock.advance_ns(60 * kSecond);
    if (!is_suspended) bench.host.bus.run_until(bench.host.clock.now_ns() + 10 * kSecond);

    const ReadResult result = bench.read_until_trouble(kSecond);
    EXPECT_EQ(result.outcome, ReadOutcome::Broken) << is_suspended;
    EXPECT_EQ(result.gap.reason, GapReason::Overrun);
    EXPECT_EQ(bench.checker->wrong(), 0U);
  }
}

TEST(UsbDaqFaults, OverrunWithSmallPackets_LargeOnesUntilClosed) {
  ToyBench bench;
  bench.device.faults.overrun_at_code = 4 * 50;
  bench.run(100, 5);
  EXPECT_FALSE(bench.device.used_large_packets);
  ASSERT_EQ(bench.read_until_trouble(2 * kSecond).gap.reason, GapReason::Overrun);

  ASSERT_TRUE(bench.daq->stop().has_value());
  ASSERT_TRUE(bench.start(100, 5).has_value());
  EXPECT_TRUE(bench.device.used_large_packets);
  EXPECT_EQ(bench.read_until_trouble(2 * kSecond).outcome, ReadOutcome::Timeout);
  EXPECT_EQ(bench.checker->wrong(), 0U);

  bench.daq->close();
  bench.run(100, 5);
  EXPECT_FALSE(bench.device.used_large_packets);
}

TEST(UsbDaqFaults, DeadButPresent_SilenceAndEveryCallReturns) {
  ToyBench bench;
  bench.run(1500);
  bench.device.faults.silence_at_code = 0;  // from the first scan
  bench.device.faults.is_mute = true;

  EXPECT_EQ(bench.read_until_trouble(2 * kSecond).gap.reason, GapReason::Silence);
  EXPECT_LE(bench.host.clock.now_ns(), bench.device.instant_ns(0) + kRunningSilenceFoundWithinNs);

  EXPECT_FALSE(bench.daq->stop().has_value()) << "nobody knows whether it still scans";
  const auto started = bench.start(1500);
  ASSERT_FALSE(started.has_value());
  EXPECT_EQ(started.error().code, ErrorCode::Timeout);
  EXPECT_EQ(bench.daq->state(), DeviceState::Open);
}

TEST(UsbDaqFaults, TookTheCommandButDoesNotRun_StartFails) {
  ToyBench bench;
  bench.device.takes_begin_without_running = true;
  ASSERT_TRUE(bench.daq->open().has_value());

  const auto started = bench.start(1500);

  ASSERT_FALSE(started.has_value());
  EXPECT_EQ(started.error().code, ErrorCode::Failed);
  EXPECT_EQ(bench.host.bus.transfers_in_flight(), 0);
  EXPECT_EQ(bench.daq->state(), DeviceState::Open);
}

}  // namespace
}  // namespace dts::device::usb
