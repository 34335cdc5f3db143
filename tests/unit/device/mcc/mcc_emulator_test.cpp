// SPDX-License-Identifier: Apache-2.0
// What the emulated units promise beyond what the drivers use: a test bench that lies proves nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/clock.h"
#include "device/mcc/fs_plus_models.h"
#include "usb/emulator/fs_plus_emulator.h"
#include "usb/emulator/sample_feed.h"

namespace dts::emulator {
namespace {

using device::mcc::encode_start;
using device::mcc::StartForm;

constexpr std::int64_t kSecond = 1000 * core::kNanosecondsPerMillisecond;

Source ramp() {
  return [](double time_s, std::span<double> volts) { std::fill(volts.begin(), volts.end(), time_s); };
}

ControlReply write(FsPlusEmulator& unit, std::uint8_t request, const std::vector<std::uint8_t>& bytes, std::int64_t now_ns = 0) {
  return unit.control({.request_type = 0x40, .request = request, .length = static_cast<std::uint16_t>(bytes.size())}, bytes, now_ns);
}

unsigned status(FsPlusEmulator& unit, std::int64_t now_ns) {
  return unit.control({.request_type = 0xC0, .request = 0x44, .length = 2}, {}, now_ns).data.at(0);
}

std::vector<std::uint8_t> start_bytes(std::uint8_t options, std::uint8_t scans = 0) {
  std::vector<std::uint8_t> bytes = encode_start(StartForm::TenBytes, {.period = 39'999, .mask = 0xFF});  // 1 kHz
  bytes[0] = scans;
  bytes[9] = options;
  return bytes;
}

TEST(ScanClock, Ticks_ExactAfterDaysAndEarlierByItsError) {
  ScanClock clock;
  clock.start(*core::Rate::create(40'000'000, 26'667), 1.0, 5);

  const std::uint64_t ticks = 40'000'000ULL * 10;  // 266,670 s
  EXPECT_EQ(clock.tick_ns(ticks), 266'670 * kSecond + 5);
  EXPECT_EQ(clock.ticks(266'670 * kSecond + 5), ticks);
  EXPECT_EQ(clock.ticks(266'670 * kSecond + 4), ticks - 1);

  clock = {};
  clock.start(*core::Rate::create(1000, 1), 1.0 + 100e-6, 0);
  EXPECT_EQ(clock.ticks(10'000 * kSecond), 10'001'000U);
}

TEST(ScanClock, Stopped_KeepsItsCount) {
  ScanClock clock;
  clock.start(*core::Rate::create(1000, 1), 1.0, 0);
  clock.stop(kSecond);
  EXPECT_EQ(clock.ticks(5 * kSecond), 1000U);
  EXPECT_EQ(clock.tick_ns(1001), kNeverNs);

  clock.start(*core::Rate::create(10, 1), 1.0, 10 * kSecond);

  EXPECT_EQ(clock.ticks(11 * kSecond), 1010U);
  EXPECT_EQ(clock.tick_ns(1001), 10 * kSecond + kSecond / 10);
}

TEST(SampleFeed, DroppedCode_IsMissingAndSpent) {
  SampleFeed feed(ramp(), 2);
  Faults faults;
  faults.drop_code_at = 3;
  feed.start(
      {.rate = *core::Rate::create(1, 1), .inputs = {0, 1}, .codes_per_tick = 2},
      [](std::size_t position, double volts) { return static_cast<std::uint16_t>(volts * 10.0 + static_cast<double>(position)); }, faults,
      0);

  std::vector<std::uint16_t> codes;
  EXPECT_EQ(feed.available(3 * kSecond), 5U);
  EXPECT_EQ(feed.ready_ns(4), 3 * kSecond);
  while (feed.available(3 * kSecond) > 0) codes.push_back(feed.take());

  EXPECT_EQ(codes, (std::vector<std::uint16_t>{0, 1, 10, 20, 21}));
  EXPECT_EQ(faults.drop_code_at, Faults::kNever);
}

TEST(SampleFeed, FollowerThatStartsLate_TakesWhatStandsThereAtEachTick) {
  ScanClock clock;
  SampleFeed feed(ramp(), 1);
  Faults faults;
  clock.start(*core::Rate::create(10, 1), 1.0, 0);
  feed.start(
      {.rate = {}, .inputs = {0}, .codes_per_tick = 1},
      [](std::size_t, double volts) { return static_cast<std::uint16_t>(std::lround(volts * 10.0)); }, faults, clock, kSecond / 2);
  std::vector<std::uint16_t> codes;

  for (; feed.available(kSecond) > 1;) codes.push_back(feed.take());
  clock.start(*core::Rate::create(10, 1), 1.0, kSecond);  // whoever ticks starts again
  while (feed.available(kSecond + kSecond / 5) > 0) codes.push_back(feed.take());

  EXPECT_EQ(codes, (std::vector<std::uint16_t>{5, 6, 7, 8, 9, 0, 1}));
}

TEST(FsPlusEmulator, EveryCodeComesOnceAndWhatIsLeftBeforeTheNextScan) {
  FsPlusEmulator unit(FsPlusKind::Usb1608, "1", ramp());
  ASSERT_EQ(write(unit, 0x11, start_bytes(0x20)).kind, ReplyKind::Done);  // the debug counter

  std::uint16_t expected = 0;
  while (const auto packet = unit.take_packet(0x81, kSecond)) {
    ASSERT_EQ(packet->bytes.size(), 64U);
    for (std::size_t i = 0; i < 64; i += 2) EXPECT_EQ(packet->bytes[i] | packet->bytes[i + 1] << 8, expected++);
  }
  EXPECT_EQ(expected, 8000);
  ASSERT_EQ(write(unit, 0x12, {}, kSecond + kSecond / 500).kind, ReplyKind::Done);  // two scans are in the FIFO
  EXPECT_EQ(unit.take_packet(0x81, 2 * kSecond)->bytes.size(), 32U);

  ASSERT_EQ(write(unit, 0x11, start_bytes(1), 2 * kSecond).kind, ReplyKind::Done);  // immediate
  EXPECT_EQ(unit.next_packet_ns(2 * kSecond), 2 * kSecond + kSecond / 1000);
  EXPECT_FALSE(unit.take_packet(0x81, 2 * kSecond + kSecond / 1000 - 1).has_value());
  EXPECT_EQ(unit.take_packet(0x81, 2 * kSecond + kSecond / 1000)->bytes.size(), 16U);
}

TEST(FsPlusEmulator, FiniteScan_EndsWithAShortOrAnEmptyPacket) {
  for (const std::uint8_t scans : {std::uint8_t{6}, std::uint8_t{8}}) {  // 96 and 128 bytes
    FsPlusEmulator unit(FsPlusKind::Usb1608, "1", ramp());
    ASSERT_EQ(write(unit, 0x11, start_bytes(0, scans)).kind, ReplyKind::Done);
    std::vector<std::size_t> sizes;
    while (const auto packet = unit.take_packet(0x81, kSecond)) sizes.push_back(packet->bytes.size());

    EXPECT_EQ(sizes, scans == 6 ? (std::vector<std::size_t>{64, 32}) : (std::vector<std::size_t>{64, 64, 0}));
    EXPECT_EQ(status(unit, kSecond), 0U);
  }
}

TEST(FsPlusEmulator, Overrun_StallsOrFallsSilentByBit7) {
  for (const bool is_silent : {false, true}) {
    FsPlusEmulator unit(FsPlusKind::Usb1608, "1", ramp());
    ASSERT_EQ(write(unit, 0x11, start_bytes(is_silent ? 0x80 : 0)).kind, ReplyKind::Done);

    const auto packet = unit.take_packet(0x81, 5 * kSecond);  // 40,000 codes

    EXPECT_EQ(packet.has_value(), !is_silent);
    EXPECT_EQ(status(unit, 5 * kSecond), 4U);
    unit.clear_halt(0x81);
    EXPECT_FALSE(unit.take_packet(0x81, 5 * kSecond).has_value());
  }
}

TEST(FsPlusEmulator, RequestsThatARealUnitRefuses_StallAndResetLeavesTheBusOnce) {
  FsPlusEmulator unit(FsPlusKind::Usb1608, "1", ramp());
  ASSERT_EQ(write(unit, 0x11, start_bytes(0)).kind, ReplyKind::Done);

  EXPECT_EQ(write(unit, 0x11, start_bytes(0)).kind, ReplyKind::Stall) << "while it scans";
  EXPECT_EQ(write(unit, 0x14, std::vector<std::uint8_t>(8)).kind, ReplyKind::Stall);
  EXPECT_EQ(unit.control({.request_type = 0xC0, .request = 0x10, .length = 2}, {}, 0).kind, ReplyKind::Stall);
  EXPECT_EQ(status(unit, 0), 2U);

  EXPECT_EQ(unit.forbidden_requests, 0);
  for (const int request : {0x30, 0x31, 0x32, 0x48, 0x50}) {
    EXPECT_EQ(write(unit, static_cast<std::uint8_t>(request), {0}).kind, ReplyKind::Stall);
  }
  EXPECT_EQ(unit.forbidden_requests, 5) << "writes to memory and firmware";

  ASSERT_EQ(write(unit, 0x42, {}).kind, ReplyKind::Done);
  EXPECT_TRUE(unit.wants_to_leave());
  EXPECT_FALSE(unit.wants_to_leave());
}

}  // namespace
}  // namespace dts::emulator
