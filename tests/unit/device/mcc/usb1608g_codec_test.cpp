// SPDX-License-Identifier: Apache-2.0
// USB-1608G, 1608GX and 1608GX-2AO: bytes by hand, and how scans are packed.
#include <gtest/gtest.h>

#include <array>

#include "device/mcc/usb1608g.h"

namespace dts::device::mcc {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(Usb1608gBytes, ScanList_InputRangeModeLast) {
  const std::array<std::size_t, 4> inputs = {3, 12, 0, 8};
  const std::array<double, 4> ranges_v = {10.0, 5.0, 2.0, 1.0};

  const auto list = encode_scan_list(inputs, ranges_v);

  EXPECT_EQ(list[0], 0x23);  // 3, +-10 V, single-ended low
  EXPECT_EQ(list[1], 0x4C);  // 12: 4 of the high ones, +-5 V
  EXPECT_EQ(list[2], 0x30);  // 0, +-2 V
  EXPECT_EQ(list[3], 0xD8);  // 8, +-1 V, the last
  EXPECT_EQ(list[4], 0);
}

TEST(Usb1608gBytes, Start_AlwaysBurst) {
  // 64 MHz / 1500 Hz - 1 = 42665.67: 42666 = 0xA6AA
  EXPECT_EQ(encode_g_start({.period = 42'666, .packet_codes = 128, .has_trigger = false}),
            (Bytes{0, 0, 0, 0, 0, 0, 0, 0, 0xAA, 0xA6, 0, 0, 127, 1}));
  EXPECT_EQ(encode_g_start({.period = 1, .packet_codes = 256, .has_trigger = true}), (Bytes{0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 255, 9}));
}

GPackets choose_g(double rate_hz, std::size_t channels, std::size_t packet_bytes, std::int64_t latency_ms,
                  bool must_use_large_packets = false) {
  return choose_g_packets({.scan_hz = rate_hz, .channels = channels, .packet_bytes = packet_bytes},
                          {.rate = *core::Rate::from_hz(rate_hz),
                           .latency_ns = latency_ms * core::kNanosecondsPerMillisecond,
                           .must_use_large_packets = must_use_large_packets});
}

TEST(Usb1608gPackets, WholeScansWithinTenMilliseconds) {
  const GPackets packets = choose_g(1500, 8, 512, 20);  // a full packet would take 21 ms

  EXPECT_EQ(packets.packet_codes, 15U * 8U);
  EXPECT_EQ(packets.transfers.transfer_bytes, 512U);
  EXPECT_EQ(packets.transfers.transfer_period_ns, 10 * core::kNanosecondsPerMillisecond);
  EXPECT_EQ(packets.transfers.transfer_count, 50U);
}

TEST(Usb1608gPackets, FullPacketsWhereOneFillsInTime) {
  const GPackets packets = choose_g(5000, 16, 512, 20);  // 3.2 ms per packet

  EXPECT_EQ(packets.packet_codes, 256U);
  EXPECT_FALSE(packets.transfers.is_immediate);
  EXPECT_EQ(packets.transfers.transfer_bytes, 3U * 512U);
}

TEST(Usb1608gPackets, SlowScan_OneScanPerPacket) { EXPECT_EQ(choose_g(50, 4, 512, 5).packet_codes, 4U); }

TEST(Usb1608gPackets, FullSpeedPort_NeverLongerThanThePacket) {
  EXPECT_EQ(choose_g(1500, 12, 64, 20).packet_codes, 32U);
  EXPECT_EQ(choose_g(100, 12, 64, 20).packet_codes, 12U);
}

TEST(Usb1608gPackets, OverrunBefore_FullPackets) { EXPECT_EQ(choose_g(50, 4, 512, 5, true).packet_codes, 256U); }

}  // namespace
}  // namespace dts::device::mcc
