// SPDX-License-Identifier: Apache-2.0
#include "ipc/encode.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace dts::ipc {
namespace {

core::StreamFormat two_channels() {
  return {.name = "cop", .rate = core::Rate::create(3000, 2).value(), .channels = {{"ml_mm", "mm"}, {"ap_mm", "mm"}}};
}

TEST(StreamEncoder, Block_ArrivesColumnByColumnWithItsPosition) {
  StreamEncoder encoder(42, "floor", two_channels());
  core::Block block(2, 8);
  block.set_count(3);
  block.segment = 2;
  block.first_scan = {1000};
  block.host_time_ns = 5;
  block.sequence = 7;
  for (std::size_t scan = 0; scan < 3; ++scan) {
    block.column(0)[scan] = static_cast<double>(scan);
    block.column(1)[scan] = 10.0 + static_cast<double>(scan);
  }

  const dts::v1::StreamBlock& message = encoder.encode(block, 11, 13);

  EXPECT_EQ(encoder.topic(), "floor/cop");
  EXPECT_EQ(std::vector<float>(message.values().begin(), message.values().end()), (std::vector<float>{0, 1, 2, 10, 11, 12}));
  EXPECT_EQ(message.instance_id(), 42U);
  EXPECT_EQ(message.segment(), 2U);
  EXPECT_EQ(message.first_scan(), 1000U);
  EXPECT_EQ(message.scan_count(), 3U);
  EXPECT_EQ(message.rate().numerator(), 1500);
  EXPECT_EQ(message.rate().denominator(), 1);
  EXPECT_EQ(message.sequence(), 7U);
  EXPECT_EQ(message.lost_scans_total(), 11U);
  EXPECT_EQ(message.dropped_blocks_total(), 13U);
}

TEST(StreamEncoder, ShorterBlockAfterALongerOne_LeavesNothingBehind) {
  StreamEncoder encoder(1, "floor", two_channels());
  core::Block block(2, 8);
  block.set_count(8);
  static_cast<void>(encoder.encode(block, 0, 0));
  block.set_count(1);

  EXPECT_EQ(encoder.encode(block, 0, 0).values_size(), 2);
}

TEST(StreamEncoder, QualityOfAnyScan_ShowsForItsChannelOnly) {
  StreamEncoder encoder(1, "floor", two_channels());
  core::Block block(2, 8);
  block.set_count(4);
  block.quality(1)[2] = core::quality::kStuck;
  block.quality(1)[3] = core::quality::kRail;
  block.column(1)[2] = std::numeric_limits<double>::quiet_NaN();

  const dts::v1::StreamBlock& message = encoder.encode(block, 0, 0);

  EXPECT_EQ(message.quality()[0], 0);
  EXPECT_EQ(message.quality()[1], core::quality::kStuck | core::quality::kRail);
  EXPECT_TRUE(std::isnan(message.values(6)));
}

TEST(GapEvent, Frame_TellsReasonAndCount) {
  core::Frame frame{.gap_before = {.reason = core::GapReason::Silence, .missing_scans = 9, .is_exact = true}, .segment = 3};

  const dts::v1::Event event = gap_event(1, frame);

  EXPECT_EQ(event.segment(), 3U);
  EXPECT_EQ(event.gap().reason(), dts::v1::GAP_REASON_SILENCE);
  EXPECT_EQ(event.gap().missing_scans(), 9U);
  EXPECT_TRUE(event.gap().is_exact());
}

}  // namespace
}  // namespace dts::ipc
