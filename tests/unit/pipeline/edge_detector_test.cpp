// SPDX-License-Identifier: Apache-2.0
#include "pipeline/edge_detector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/special_numbers.h"

namespace dts::pipeline {
namespace {

using core::kNaN;

core::Rate rate_1500() { return *core::Rate::create(40'000'000, 26'667); }

/// Column 1 of blocks of `block_scans`; column 0 is noise of another channel.
std::vector<core::TriggerEvent> edges(EdgeDetector& detector, const std::vector<double>& volts, std::size_t block_scans) {
  std::vector<core::TriggerEvent> found;
  for (std::size_t first = 0; first < volts.size(); first += block_scans) {
    core::Block block(2, block_scans);
    block.set_count(std::min(block_scans, volts.size() - first));
    block.segment = 3;
    block.first_scan = {first};
    block.host_time_ns = 1'000'000 + rate_1500().time_ns({first});
    for (std::size_t i = 0; i < block.count(); ++i) {
      block.column(0)[i] = i % 2 == 0 ? 5.0 : 0.0;
      block.column(1)[i] = volts[first + i];
    }
    core::TriggerEvents out;
    detector.process(block, 1, out);
    found.insert(found.end(), out.events.begin(), out.events.begin() + static_cast<std::ptrdiff_t>(out.count));
  }
  return found;
}

TEST(EdgeDetector, Edges_AreFoundAtTheirScanWhateverTheBlocks) {
  RecordProperty("requirement", "ACQ-17");
  std::vector<double> volts(100, 0.1);
  for (std::size_t scan = 37; scan < 64; ++scan) volts[scan] = 4.9;
  for (const std::size_t block_scans : {1U, 7U, 37U, 100U}) {
    EdgeDetector detector({.channel = 4, .edges = TriggerEdges::Both}, rate_1500());

    const auto found = edges(detector, volts, block_scans);

    ASSERT_EQ(found.size(), 2U) << block_scans;
    EXPECT_EQ(found[0].scan.value, 37U);
    EXPECT_TRUE(found[0].is_rising);
    EXPECT_EQ(found[0].segment, 3U);
    EXPECT_NEAR(static_cast<double>(found[0].host_time_ns), 1e6 + 37 * 26'667 * 25.0, 2.0);
    EXPECT_EQ(found[1].scan.value, 64U);
    EXPECT_FALSE(found[1].is_rising);
  }
}

TEST(EdgeDetector, GivesOnlyTheEdgesThatAreWanted) {
  const std::vector<double> volts{0, 5, 0, 5, 0};
  EdgeDetector rising({.edges = TriggerEdges::Rising}, rate_1500());
  EdgeDetector falling({.edges = TriggerEdges::Falling}, rate_1500());

  EXPECT_EQ(edges(rising, volts, 5).size(), 2U);
  EXPECT_EQ(edges(falling, volts, 5).size(), 2U);
  EXPECT_EQ(edges(rising, volts, 5)[0].scan.value, 1U);
}

TEST(EdgeDetector, NoiseInsideTheBand_IsNoEdge) {
  EdgeDetector detector({.level = 2.5, .hysteresis = 0.5, .edges = TriggerEdges::Both}, rate_1500());

  EXPECT_TRUE(edges(detector, {0, 2.7, 2.3, 2.74, 2.26, kNaN, 2.7}, 7).empty());
  EXPECT_EQ(edges(detector, {2.76}, 1).size(), 1U);
}

TEST(EdgeDetector, FirstScanAfterAReset_IsNoEdge) {
  EdgeDetector detector({.edges = TriggerEdges::Both}, rate_1500());
  EXPECT_TRUE(edges(detector, {5, 5}, 2).empty());
  detector.reset();
  EXPECT_TRUE(edges(detector, {0, 0}, 2).empty());
}

TEST(EdgeDetector, ChatterBeyondTheRoomOfAFrame_IsCounted) {
  EdgeDetector detector({.edges = TriggerEdges::Both}, rate_1500());
  core::Block block(1, 100);
  block.set_count(100);
  for (std::size_t scan = 0; scan < 100; ++scan) block.column(0)[scan] = scan % 2 == 0 ? 5.0 : 0.0;
  core::TriggerEvents out;

  detector.process(block, 0, out);

  EXPECT_EQ(out.count, core::kMaxTriggersPerFrame);
  EXPECT_EQ(out.count + out.lost, 99U);
}

TEST(TriggerInput, BadNumbers_AreRefused) {
  EXPECT_TRUE(check({}));
  EXPECT_FALSE(check({.level = kNaN}));
  EXPECT_FALSE(check({.hysteresis = -0.1}));
}

}  // namespace
}  // namespace dts::pipeline
