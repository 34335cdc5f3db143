// SPDX-License-Identifier: Apache-2.0
#include "device/usb/scan_buffer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

namespace dts::device::usb {
namespace {

/// Writes `count` codes that count up from `next`.
void write(ScanBuffer& buffer, std::size_t count, std::uint16_t& next) {
  const std::span<std::uint16_t> room = buffer.room();
  ASSERT_GE(room.size(), count);
  for (std::size_t i = 0; i < count; ++i) room[i] = next++;
  buffer.add(count);
}

TEST(ScanBuffer, AnyPiecesAndTakes_PhaseIsKept) {
  for (const std::size_t channels : {1U, 3U, 5U, 8U}) {
    ScanBuffer buffer(channels, 40);
    std::uint16_t next = 0;
    std::uint16_t expected = 0;
    for (std::size_t step = 0; step < 5000; ++step) {
      write(buffer, std::min<std::size_t>(step * 7 % 33, buffer.room().size()), next);
      for (std::size_t scan = 0; scan < buffer.scans(); ++scan) {
        for (std::size_t i = 0; i < channels; ++i) {
          ASSERT_EQ(buffer.scan(scan)[i], static_cast<std::uint16_t>(expected + scan * channels + i)) << channels << " at " << step;
        }
      }
      const std::size_t taken = std::min<std::size_t>(buffer.scans(), step % 50);
      buffer.remove(taken);
      expected = static_cast<std::uint16_t>(expected + taken * channels);
    }
  }
}

TEST(ScanBuffer, HalfTaken_HalfIsRoomAndMoreThanFitsIsCut) {
  ScanBuffer buffer(2, 9);  // 20 codes
  std::uint16_t next = 0;
  write(buffer, 19, next);
  EXPECT_EQ(buffer.scans(), 9U) << "the incomplete one is none";
  write(buffer, 1, next);
  EXPECT_EQ(buffer.room().size(), 0U);

  buffer.remove(5);

  EXPECT_EQ(buffer.room().size(), 10U);
  EXPECT_EQ(buffer.scan(0)[0], 10);
  buffer.add(100);
  EXPECT_EQ(buffer.scans(), 10U);
  buffer.clear();
  EXPECT_EQ(buffer.scans(), 0U);
  EXPECT_EQ(buffer.room().size(), 20U);
}

TEST(ScanBuffer, DropIncomplete_NextCodeIsChannelZero) {
  ScanBuffer buffer(3, 10);
  std::uint16_t next = 0;
  write(buffer, 8, next);

  buffer.drop_incomplete();
  write(buffer, 3, next);

  ASSERT_EQ(buffer.scans(), 3U);
  EXPECT_EQ(buffer.scan(2)[0], 8);
}

}  // namespace
}  // namespace dts::device::usb
