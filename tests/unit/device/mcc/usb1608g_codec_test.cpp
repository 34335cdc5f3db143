// SPDX-License-Identifier: Apache-2.0
// USB-1608G, 1608GX and 1608GX-2AO: how scans are packed. Their bytes are in conversations/usb_1608g.txt.
#include <gtest/gtest.h>

#include <string>

#include "device/mcc/usb1608g.h"

namespace dts::device::mcc {
namespace {

TEST(Usb1608gPackets, WholeScansWithinTenMillisecondsUnlessAFullPacketFillsInTime) {
  struct Row {
    double rate_hz;
    std::size_t channels;
    std::size_t packet_bytes;  // 64: a full speed port
    double latency_ms;
    bool must_use_large_packets;
    std::size_t packet_codes;
    bool is_immediate;
    std::size_t transfer_bytes;
    std::size_t transfer_count;
    std::int64_t transfer_period_ns;
  };
  for (const Row& row :
       {Row{1500, 8, 512, 20, false, 120, true, 512, 50, 10'000'000},  // a full packet would take 21 ms
        Row{1500, 8, 512, 5, false, 56, true, 512, 108, 4'666'667}, Row{5000, 16, 512, 20, false, 256, false, 1536, 53, 9'600'000},
        Row{5000, 16, 512, 4, false, 256, false, 512, 157, 3'200'000}, Row{3200, 8, 512, 10, false, 256, false, 512, 50, 10'000'000},
        Row{3199, 8, 512, 10, false, 31 * 8, true, 512, 52, 9'690'528}, Row{50, 4, 512, 5, false, 4, true, 512, 25, 20'000'000},
        Row{50, 4, 512, 5, true, 256, false, 512, 8, 1'280'000'000}, Row{1500, 12, 64, 20, false, 32, false, 320, 57, 8'888'889},
        Row{100, 12, 64, 20, false, 12, true, 64, 50, 10'000'000}, Row{1, 33, 64, 20, false, 32, false, 64, 8, 969'696'970}}) {
    const GPackets packets = choose_g_packets({.scan_hz = row.rate_hz, .channels = row.channels, .packet_bytes = row.packet_bytes},
                                              {.rate = *core::Rate::from_hz(row.rate_hz),
                                               .latency_ns = static_cast<std::int64_t>(row.latency_ms * 1e6),
                                               .must_use_large_packets = row.must_use_large_packets});
    SCOPED_TRACE(std::to_string(row.rate_hz) + " Hz, " + std::to_string(row.channels) + " channels");
    EXPECT_EQ(packets.packet_codes, row.packet_codes);
    EXPECT_EQ(packets.transfers.is_immediate, row.is_immediate);
    EXPECT_EQ(packets.transfers.transfer_bytes, row.transfer_bytes);
    EXPECT_EQ(packets.transfers.transfer_count, row.transfer_count);
    EXPECT_EQ(packets.transfers.transfer_period_ns, row.transfer_period_ns);
  }
}

}  // namespace
}  // namespace dts::device::mcc
