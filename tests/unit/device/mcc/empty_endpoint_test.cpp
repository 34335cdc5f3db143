// SPDX-License-Identifier: Apache-2.0
// Emptying the data endpoint before a scan.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "device/mcc/control.h"
#include "device/mcc/fs_plus.h"
#include "unit/device/mcc/mcc_bench.h"
#include "usb/emulator/fs_plus_emulator.h"

namespace dts::device::mcc {
namespace {

using emulator::FsPlusEmulator;
using emulator::FsPlusKind;
using test::kMillisecond;
using test::kSecond;
using test::moving_source;

/// Its endpoint gives a packet, then halts, and has two more packets behind the halt.
class HaltedInTheMiddle final : public emulator::EmulatedDevice {
 public:
  [[nodiscard]] const emulator::Descriptors& descriptors() const override { return unit_.descriptors(); }
  void power_up(std::int64_t now_ns) override { unit_.power_up(now_ns); }
  [[nodiscard]] emulator::ControlReply control(const emulator::Setup& setup, std::span<const std::uint8_t> data,
                                               std::int64_t now_ns) override {
    return unit_.control(setup, data, now_ns);
  }
  void bulk_out(std::uint8_t, std::span<const std::uint8_t>, std::int64_t) override {}
  [[nodiscard]] std::optional<emulator::Packet> take_packet(std::uint8_t, std::int64_t) override {
    if (packets_left == 2 && is_halted_) return emulator::Packet{.is_stall = true, .bytes = {}};
    if (packets_left == 0) return std::nullopt;
    is_halted_ = --packets_left == 2;
    return emulator::Packet{.is_stall = false, .bytes = std::vector<std::uint8_t>(2)};
  }
  void clear_halt(std::uint8_t) override { is_halted_ = false; }
  [[nodiscard]] std::int64_t next_packet_ns(std::int64_t now_ns) const override {
    return packets_left > 0 ? now_ns : std::numeric_limits<std::int64_t>::max();
  }

  int packets_left = 3;

 private:
  FsPlusEmulator unit_{FsPlusKind::Usb1608, "1", moving_source()};
  bool is_halted_ = false;
};

TEST(EmptyEndpoint, HaltWhileTheEndpointIsEmptied_WhatStandsBehindItIsTakenToo) {
  HaltedInTheMiddle halted;
  core::VirtualClock clock{kSecond};
  emulator::FakeBus bus(clock);
  bus.plug(halted);
  auto port = bus.open(bus.units({&usb_1608fs_plus().usb, 1})->front());
  ASSERT_TRUE(port.has_value());

  EXPECT_TRUE(empty_endpoint(**port, 0x81).has_value());

  EXPECT_EQ(halted.packets_left, 0);
}

/// Sends a full packet every 1.9 ms, whatever it is told.
class Sender final : public emulator::EmulatedDevice {
 public:
  [[nodiscard]] const emulator::Descriptors& descriptors() const override { return unit_.descriptors(); }
  void power_up(std::int64_t) override {}
  [[nodiscard]] emulator::ControlReply control(const emulator::Setup&, std::span<const std::uint8_t>, std::int64_t) override { return {}; }
  void bulk_out(std::uint8_t, std::span<const std::uint8_t>, std::int64_t) override {}
  [[nodiscard]] std::optional<emulator::Packet> take_packet(std::uint8_t, std::int64_t now_ns) override {
    if (now_ns < next_ns_) return std::nullopt;
    next_ns_ = now_ns + kPeriodNs;
    return emulator::Packet{.is_stall = false, .bytes = std::vector<std::uint8_t>(64)};
  }
  void clear_halt(std::uint8_t) override {}
  [[nodiscard]] std::int64_t next_packet_ns(std::int64_t now_ns) const override { return std::max(now_ns, next_ns_); }

 private:
  static constexpr std::int64_t kPeriodNs = 1'900'000;
  FsPlusEmulator unit_{FsPlusKind::Usb1608, "1", moving_source()};
  std::int64_t next_ns_ = 0;
};

TEST(EmptyEndpoint, DeviceThatGoesOnSending_GivenUpAfterAQuarterOfASecond) {
  Sender sender;
  core::VirtualClock clock{kSecond};
  emulator::FakeBus bus(clock);
  bus.plug(sender);
  auto port = bus.open(bus.units({&usb_1608fs_plus().usb, 1})->front());
  ASSERT_TRUE(port.has_value());
  const std::int64_t before_ns = clock.now_ns();

  EXPECT_FALSE(empty_endpoint(**port, 0x81).has_value());

  EXPECT_LE(clock.now_ns() - before_ns, 260 * kMillisecond);
}

}  // namespace
}  // namespace dts::device::mcc
