// SPDX-License-Identifier: Apache-2.0
// The whole way with faults: each is found, and told as what it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "device/labjack/u6.h"
#include "device/labjack/u6_frames.h"
#include "unit/device/labjack/u6_rig.h"

namespace dts::device::labjack {
namespace {

using core::ErrorCode;
using core::GapReason;
using namespace test_u6;

void expect_broken(const ReadResult& result, GapReason reason) {
  EXPECT_EQ(result.outcome, ReadOutcome::Broken);
  EXPECT_EQ(result.gap.reason, reason);
}

/// The same fault does not happen twice: a new scan is as good as the first.
void expect_restart(Rig& rig, double rate_hz) {
  EXPECT_TRUE(rig.device->stop().has_value());
  EXPECT_EQ(rig.bus.transfers_in_flight(), 0);
  rig.restart(rate_hz);
  EXPECT_EQ(rig.read_and_check(200).outcome, ReadOutcome::Scans);
}

TEST(U6Faults, FaultOfTheStream_ToldBeforeAnyWrongScanThenStartsAgain) {
  for (std::uint64_t emulator::Faults::*fault :
       {&emulator::Faults::skip_counter_at_code, &emulator::Faults::drop_packet_at_code, &emulator::Faults::corrupt_at_code,
        &emulator::Faults::short_packet_at_code, &emulator::Faults::drop_code_at, &emulator::Faults::stall_at_code}) {
    for (const double rate_hz : {100.0, 1500.0}) {
      Rig rig("labjack:u6?channels=8,9,10,11&marker=15&marker_v=0");  // the marker finds a missing sample
      rig.unit.faults.*fault = 5 * 300;
      rig.start(rate_hz);
      expect_broken(rig.read_and_check(1000), fault == &emulator::Faults::stall_at_code ? GapReason::Stall : GapReason::Integrity);
      EXPECT_LE(rig.taken, 300U);
      expect_restart(rig, rate_hz);
    }
  }
}

TEST(U6Faults, HostStandsStill_RecoversWithExactGap) {
  Rig rig(kEleven);
  rig.start(1500);
  ASSERT_EQ(rig.read_and_check(3000).outcome, ReadOutcome::Scans);
  rig.segment_start = 0;
  rig.clock.advance_ns(2 * kSecond);  // nobody fetches anything: 3000 scans, of which the FIFO holds 89

  std::uint64_t before = rig.block.first_scan.value + rig.block.count();
  ReadResult result = rig.read();
  for (; result.outcome == ReadOutcome::Scans; result = rig.read()) {
    EXPECT_EQ(rig.wrong_values(), 0U);
    before += rig.block.count();
  }

  EXPECT_EQ(result.outcome, ReadOutcome::Gap);
  EXPECT_EQ(result.gap.reason, GapReason::Overrun);
  EXPECT_TRUE(result.gap.is_exact);
  EXPECT_GT(result.gap.missing_scans, 2800U);
  rig.segment_start = before + result.gap.missing_scans;
  ASSERT_EQ(rig.read_and_check(3000).outcome, ReadOutcome::Scans);  // at the right place of the ramp
  EXPECT_TRUE(rig.unit.is_streaming());
}

TEST(U6Faults, OverrunAtLowRate_RecoversWithExactGap) {
  Rig rig("labjack:u6?channels=0,1,2,3");
  rig.unit.faults.overrun_at_code = 4 * 500 + 2;
  rig.start(100, 10);
  const ReadResult result = rig.read_and_check(1000);
  EXPECT_EQ(result.outcome, ReadOutcome::Gap);
  EXPECT_EQ(result.gap.missing_scans, U6Emulator::kForcedLossScans);
  EXPECT_TRUE(result.gap.is_exact);
  EXPECT_EQ(rig.taken, 500U);
  rig.segment_start = 500 + U6Emulator::kForcedLossScans;
  EXPECT_EQ(rig.read_and_check(500).outcome, ReadOutcome::Scans);
}

TEST(U6Faults, RecoveryThatCannotBeBelievedOrOverlap_NewScan) {
  for (const char* doubt : {"count", "dummy scan", "overlap"}) {
    SCOPED_TRACE(doubt);
    Rig rig(kEleven);
    rig.unit.quirks.is_discarded_count_wide = doubt == std::string("count");
    rig.unit.quirks.has_dummy_scan = doubt != std::string("dummy scan");
    (doubt == std::string("overlap") ? rig.unit.quirks.scan_overlap_at_code : rig.unit.faults.overrun_at_code) = 11 * 500;
    rig.start(1500);
    expect_broken(rig.read_and_check(5000), GapReason::Overrun);
    expect_restart(rig, 1500);
  }
}

TEST(U6Faults, LostMoreThanItCanCount_NewScan) {
  Rig rig(kEleven);
  rig.start(1500);
  ASSERT_EQ(rig.read_and_check(1000).outcome, ReadOutcome::Scans);
  rig.clock.advance_ns(60 * kSecond);  // 90000 scans
  ReadResult result = rig.read();
  while (result.outcome == ReadOutcome::Scans) result = rig.read();
  expect_broken(result, GapReason::Overrun);
  expect_restart(rig, 1500);
}

TEST(U6Faults, MuteWhileStreaming_BrokenAndStopInTime) {
  Rig rig(kEleven);
  rig.start(1500);
  ASSERT_EQ(rig.read_and_check(1000).outcome, ReadOutcome::Scans);
  rig.unit.faults.is_mute = true;
  rig.unit.faults.silence_at_code = 0;
  ReadResult result = rig.read();
  while (result.outcome == ReadOutcome::Scans) result = rig.read();
  expect_broken(result, GapReason::Silence);
  const std::int64_t before_ns = rig.clock.now_ns();
  (void)rig.device->stop();
  EXPECT_LE(rig.clock.now_ns() - before_ns, 400 * kMillisecond);  // it does not answer
  EXPECT_EQ(rig.bus.transfers_in_flight(), 0);
  EXPECT_FALSE(rig.device->start({rig.rate, 64}).has_value());
}

TEST(U6Faults, StreamOfACrashedProgram_EndedAtOpen) {
  Rig rig(kEleven);
  const StreamSetup setup{.samples_per_packet = 25, .scan_config = 0x08, .interval = 4800, .channels = {3, 4}, .options = {0, 0}};
  rig.unit.bulk_out(kCommandEndpoint, configure_stream(setup).bytes, rig.clock.now_ns());
  rig.unit.bulk_out(kCommandEndpoint, start_stream().bytes, rig.clock.now_ns());  // two replies nobody fetches, either
  ASSERT_TRUE(rig.unit.is_streaming());
  rig.clock.advance_ns(30 * kMillisecond);

  rig.start(1500);

  const auto checks = rig.device->report().checks;
  const auto found =
      std::find_if(checks.begin(), checks.end(), [](const DeviceCheck& check) { return check.name == "no scan was running"; });
  ASSERT_NE(found, checks.end());
  EXPECT_EQ(found->outcome, DeviceCheck::Outcome::Warning);
  EXPECT_EQ(rig.read_and_check(1000).outcome, ReadOutcome::Scans);
}

TEST(U6Faults, OldFirmwareLeavesData_TheyAreNotOurs) {
  Rig rig(kEleven, {.firmware_major = 0, .firmware_minor = 93});
  rig.start(1500);
  ASSERT_EQ(rig.read_and_check(1000).outcome, ReadOutcome::Scans);
  rig.clock.advance_ns(20 * kMillisecond);
  expect_restart(rig, 1500);
}

TEST(U6Faults, StopWasLost_NextStartEndsTheOldStream) {
  Rig rig(kEleven);
  rig.start(1500);
  ASSERT_EQ(rig.read_and_check(1000).outcome, ReadOutcome::Scans);
  rig.unit.faults.silent_control_requests = 1;
  (void)rig.device->stop();
  EXPECT_TRUE(rig.unit.is_streaming());
  rig.restart(1500);
  EXPECT_EQ(rig.read_and_check(1000).outcome, ReadOutcome::Scans);
}

TEST(U6Faults, WrongChecksumOfACommand_TheUnitSaysB8) {
  Rig rig(kEleven);
  auto port = rig.bus.open((*rig.bus.units(u6_models()))[0]);
  ASSERT_TRUE(port.has_value());
  Command command = read_unit();
  command.bytes[0] = static_cast<std::uint8_t>(command.bytes[0] + 1);
  const auto reply = exchange(**port, command);
  ASSERT_FALSE(reply.has_value());
  EXPECT_EQ(reply.error().code, ErrorCode::DataDamaged);
  EXPECT_NE(reply.error().what.find("wrong checksum"), std::string::npos);
}

}  // namespace
}  // namespace dts::device::labjack
