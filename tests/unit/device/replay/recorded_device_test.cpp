// SPDX-License-Identifier: Apache-2.0
#include "device/replay/recorded_device.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "device/replay/scan_merger.h"

namespace dts::device::replay {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::NanSensitiveDoubleEq;

TEST(ParseState, Numbers_ReadBackExactly) {
  EXPECT_THAT(parse_state("").value(), IsEmpty());
  EXPECT_THAT(parse_state("0.1 nan -1e-300 5e-324 3").value(), ElementsAre(0.1, NanSensitiveDoubleEq(std::nan("")), -1e-300, 5e-324, 3.0));
}

TEST(ParseState, WhatIsNoNumber_IsDamage) {
  for (const char* text : {"1 2 x", "1,2", "1e999", "0x10", "1 2,"}) {
    const auto parsed = parse_state(text);
    ASSERT_FALSE(parsed) << text;
    EXPECT_EQ(parsed.error().code, core::ErrorCode::DataDamaged) << text;
  }
}

/// Two raw channels on device channels 1 and 0, one aux channel on 2, at 10 Hz: scans leave ten scans late.
RecordedDevice small_device() {
  RecordedDevice device;
  device.description.channels.resize(3);
  device.rate = core::Rate::create(10, 1).value();
  device.raw_stream = 0;
  device.aux_stream = 1;
  device.quality_stream = 2;
  device.raw_channels = {1, 0};
  device.aux_channels = {2};
  return device;
}

record::RecordedScans scans(std::size_t stream, std::uint64_t first, std::size_t count, std::uint32_t segment = 0) {
  record::RecordedScans made{
      .stream = stream, .segment = segment, .first_scan = {first}, .first_time_s = 0.1 * static_cast<double>(first), .count = count};
  for (std::size_t i = 0; i < count; ++i) {
    const auto scan = static_cast<double>(first + i);
    if (stream == 0) made.values.push_back(scan);
    made.values.push_back(stream == 0 ? -scan : 1000.0 + scan);
  }
  return made;
}

TEST(ScanMerger, ColumnsAndLateQuality_StandWhereTheDeviceHadThem) {
  ScanMerger merger(small_device());
  core::Block block(3, 64);
  core::Gap gap;

  ASSERT_TRUE(merger.add(scans(0, 5, 20)));
  EXPECT_EQ(merger.take(block, gap), ScanMerger::Taken::Nothing) << "aux is not there yet";
  ASSERT_TRUE(merger.add(scans(1, 3, 30)));
  ASSERT_TRUE(merger.add(record::RecordedChange{.stream = 2, .scan = {7}, .values = {1.0, 2.0, 4.0}}));
  ASSERT_EQ(merger.take(block, gap), ScanMerger::Taken::Scans);

  ASSERT_EQ(block.count(), 10U) << "a second of scans is held back";
  EXPECT_EQ(block.first_scan.value, 5U);
  EXPECT_EQ(block.column(1)[0], 5.0);
  EXPECT_EQ(block.column(0)[0], -5.0);
  EXPECT_EQ(block.column(2)[9], 1014.0);
  EXPECT_EQ(block.quality(1)[1], 0);
  EXPECT_EQ(block.quality(1)[2], 1);
  EXPECT_EQ(block.quality(0)[9], 2);
  EXPECT_EQ(block.quality(2)[2], 4);
  merger.finish();
  ASSERT_EQ(merger.take(block, gap), ScanMerger::Taken::Scans);
  EXPECT_EQ(block.count(), 10U);
  EXPECT_EQ(merger.take(block, gap), ScanMerger::Taken::Nothing);
}

TEST(ScanMerger, StreamsThatContradictEachOther_AreDamage) {
  const auto code_of = [](std::vector<record::RecordedItem> items) {
    ScanMerger merger(small_device());
    core::Block block(3, 64);
    core::Gap gap;
    for (const auto& item : items) {
      const auto added = merger.add(item);
      if (!added) return added.error().code;
      (void)merger.take(block, gap);
    }
    return core::ErrorCode{};
  };
  auto short_scans = scans(0, 0, 10);
  short_scans.values.pop_back();
  const record::RecordedChange late{.stream = 2, .scan = {1}, .values = {1.0, 1.0, 1.0}};
  const record::RecordedChange narrow{.stream = 2, .scan = {1}, .values = {1.0}};
  const record::RecordedChange wild{.stream = 2, .scan = {1}, .values = {std::nan(""), 1e300, 0.0}};

  EXPECT_EQ(code_of({scans(0, 0, 10), scans(0, 5, 10)}), core::ErrorCode::DataDamaged) << "twice";
  EXPECT_EQ(code_of({scans(0, 0, 10), scans(1, 2, 10)}), core::ErrorCode::DataDamaged) << "aux begins late";
  EXPECT_EQ(code_of({short_scans}), core::ErrorCode::DataDamaged);
  EXPECT_EQ(code_of({scans(0, 0, 40), scans(1, 0, 40), late}), core::ErrorCode::DataDamaged);
  EXPECT_EQ(code_of({narrow}), core::ErrorCode::DataDamaged);
  EXPECT_EQ(code_of({wild}), core::ErrorCode::DataDamaged);
  EXPECT_EQ(code_of({scans(0, 0, 40), scans(1, 0, 40)}), core::ErrorCode{});
}

TEST(ScanMerger, HoleThatNoEventTellsOf_IsCountedByTheTimeStamps) {
  ScanMerger merger(small_device());
  core::Block block(3, 64);
  core::Gap gap;
  auto raw = scans(0, 0, 10, 1);
  auto aux = scans(1, 0, 10, 1);
  raw.first_time_s = aux.first_time_s = 1.0 + 2.5;  // the segment before has ended at 1.0 s
  for (const auto& item : {scans(0, 0, 10), scans(1, 0, 10), raw, aux}) ASSERT_TRUE(merger.add(item));
  merger.finish();

  EXPECT_EQ(merger.take(block, gap), ScanMerger::Taken::Scans);
  EXPECT_EQ(merger.take(block, gap), ScanMerger::Taken::Gap);

  EXPECT_EQ(gap.reason, core::GapReason::Silence);
  EXPECT_EQ(gap.missing_scans, 25U);
  EXPECT_FALSE(gap.is_exact);
  EXPECT_EQ(merger.take(block, gap), ScanMerger::Taken::Scans);
  EXPECT_EQ(block.segment, 1U);
}

}  // namespace
}  // namespace dts::device::replay
