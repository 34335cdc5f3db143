// SPDX-License-Identifier: Apache-2.0
#include "record/export/lanes.h"

#include <gtest/gtest.h>

#include <atomic>
#include <new>
#include <vector>

namespace dts::record {
namespace {

RecordedItem item(std::size_t stream, std::uint64_t scan, std::size_t values = 1) {
  return RecordedScans{.stream = stream, .first_scan = {scan}, .values = std::vector<double>(values)};
}

TEST(Lanes, ManyItems_EachLaneKeepsItsOrder) {
  constexpr std::size_t kItems = 5000;
  std::vector<std::vector<std::uint64_t>> seen(2);  // each written by one lane only
  Lanes lanes(2, [&](const RecordedItem& given) {
    const auto& scans = std::get<RecordedScans>(given);
    seen[scans.stream].push_back(scans.first_scan.value);
    return core::Status{};
  });

  for (std::uint64_t scan = 0; scan < kItems; ++scan) {
    for (std::size_t lane = 0; lane < 2; ++lane) lanes.give(lane, item(lane, scan));
  }
  ASSERT_TRUE(lanes.finish().has_value());

  for (const auto& scans : seen) {
    ASSERT_EQ(scans.size(), kItems);
    for (std::uint64_t scan = 0; scan < kItems; ++scan) ASSERT_EQ(scans[scan], scan);
  }
}

TEST(Lanes, MoreThanALaneHolds_GivingWaitsAndNothingIsLost) {
  std::atomic<std::size_t> seen = 0;
  Lanes lanes(1, [&](const RecordedItem&) {
    ++seen;
    return core::Status{};
  });

  for (std::uint64_t scan = 0; scan < 50; ++scan) lanes.give(0, item(0, scan, 200'000));
  ASSERT_TRUE(lanes.finish().has_value());

  EXPECT_EQ(seen.load(), 50U);
}

TEST(Lanes, WorkThatFails_EndsTheOthersAndIsReported) {
  Lanes lanes(2, [&](const RecordedItem& given) -> core::Status {
    if (std::get<RecordedScans>(given).first_scan.value == 3) return core::fail(core::ErrorCode::Failed, "disk full");
    return {};
  });

  // Far more than the lanes hold: giving must not wait for a lane that has given up.
  for (std::uint64_t scan = 0; scan < 100; ++scan) lanes.give(scan % 2, item(0, scan, 200'000));
  const core::Status status = lanes.finish();

  ASSERT_FALSE(status.has_value());
  EXPECT_EQ(status.error().what, "disk full");
  EXPECT_TRUE(lanes.has_failed());
}

TEST(Lanes, WorkThatThrows_BecomesAnError) {
  Lanes lanes(1, [](const RecordedItem&) -> core::Status { throw std::bad_alloc(); });

  lanes.give(0, item(0, 0));

  EXPECT_FALSE(lanes.finish().has_value());
}

TEST(Lanes, NeverFinished_EndWithTheObject) {
  Lanes lanes(3, [](const RecordedItem&) { return core::Status{}; });
  for (std::uint64_t scan = 0; scan < 30; ++scan) lanes.give(scan % 3, item(0, scan));
}

}  // namespace
}  // namespace dts::record
