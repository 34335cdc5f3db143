// SPDX-License-Identifier: Apache-2.0
#include "device/replay/scan_merger.h"

#include <gtest/gtest.h>

namespace dts::device::replay {
namespace {

/// Of one sensor and one channel beside it, at 1000 Hz.
RecordedDevice two_channels() {
  RecordedDevice device;
  device.description.channels.resize(2);
  device.rate = core::Rate::create(1000, 1).value();
  device.raw_stream = 0;
  device.aux_stream = 1;
  device.raw_channels = {0};
  device.aux_channels = {1};
  return device;
}

record::RecordedScans chunk(std::size_t stream, std::uint64_t first, std::size_t scans) {
  return {.stream = stream, .first_scan = {first}, .count = scans, .values = std::vector<double>(scans, 0.5)};
}

/// How many chunks of `scans` scans of one stream alone it takes until the merger refuses them; `at_most` when it does not.
std::size_t taken_alone(std::size_t stream, std::size_t scans, std::size_t at_most) {
  ScanMerger merger(two_channels());
  for (std::size_t taken = 0; taken < at_most; ++taken) {
    const auto added = merger.add(chunk(stream, taken * scans, scans));
    if (added) continue;
    EXPECT_EQ(added.error().code, core::ErrorCode::DataDamaged);
    return taken;
  }
  return at_most;
}

TEST(ScanMerger, OneStreamWithoutTheOther_IsRefusedBeforeItFillsTheMemory) {
  for (const std::size_t stream : {0U, 1U}) {
    SCOPED_TRACE(stream);
    EXPECT_LT(taken_alone(stream, 100'000, 200), 200U) << "160 MB";
    EXPECT_LT(taken_alone(stream, 1, 500'000), 500'000U) << "as many lists of one value";
  }
}

TEST(ScanMerger, AuxThatBeganEarlier_IsLeftOutAndNotCounted) {
  ScanMerger merger(two_channels());
  core::Block block(2, 256);
  core::Gap gap;
  std::uint64_t scans = 0;
  // Aux runs half a second ahead for longer than any buffer: what was taken must make room.
  ASSERT_TRUE(merger.add(chunk(1, 0, 500)));
  for (std::uint64_t first = 0; first < 20'000'000; first += 50'000) {
    ASSERT_TRUE(merger.add(chunk(1, 500 + first, 50'000)));
    ASSERT_TRUE(merger.add(chunk(0, 250 + first, 50'000)));
    while (merger.take(block, gap) == ScanMerger::Taken::Scans) {
      if (scans == 0) {
        EXPECT_EQ(block.first_scan.value, 250U);
      }
      scans += block.count();
    }
  }
  merger.finish();
  while (merger.take(block, gap) == ScanMerger::Taken::Scans) scans += block.count();
  EXPECT_EQ(scans, 20'000'000U);
}

}  // namespace
}  // namespace dts::device::replay
