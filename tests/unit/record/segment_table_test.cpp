// SPDX-License-Identifier: Apache-2.0
#include "record/segment_table.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>

namespace dts::record {
namespace {

/// 1000 Hz and every tenth scan. The last scan before a gap of two is at 1.000 s.
TEST(SegmentTable, TheScanOfASlowStreamBeforeAShortGap_IsOfTheSegmentBefore) {
  RecordProperty("requirement", "LIB-1");
  const core::Rate raw = core::Rate::from_hz(1000.0).value();
  const core::Rate slow = core::Rate::from_hz(100.0).value();
  SegmentTable table;
  table.add({.segment = 1, .time_s = 1.003, .scan_0_time_s = 1.003});
  table.add({.segment = 0, .time_s = 0.9, .scan_0_time_s = 0.9});
  table.sort();

  const auto before = table.place_of(1.0, slow, raw);
  const auto after = table.place_of(1.003, slow, raw);
  const auto early = table.place_of(1.0026, raw, raw);

  EXPECT_EQ((std::pair(before.segment, before.scan.value)), (std::pair(0U, std::uint64_t{10})));
  EXPECT_EQ((std::pair(after.segment, after.scan.value)), (std::pair(1U, std::uint64_t{0})));
  EXPECT_EQ(early.segment, 1U) << "less than half a raw scan before the start";
}

}  // namespace
}  // namespace dts::record
