// SPDX-License-Identifier: Apache-2.0
// What leaves on the bus, as whole messages: every input has a value of its own.
#include "ipc/encode.h"

#include <gtest/gtest.h>

#include <limits>

#include "unit/ipc/message_text.h"

namespace dts::ipc {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(StreamEncoder, Block_ArrivesColumnByColumnWithItsPosition_AndWithoutAnythingOfALongerOneBefore) {
  RecordProperty("requirement", "PUB-1");
  StreamEncoder encoder(42, "floor",
                        {.name = "cop", .rate = core::Rate::create(3000, 2).value(), .channels = {{"ml_mm", "mm"}, {"ap_mm", "mm"}}});
  core::Block block(2, 8);
  block.set_count(8);
  static_cast<void>(encoder.encode(block, 0, 0));
  block.set_count(3);
  block.segment = 2;
  block.first_scan = {1000};
  block.host_time_ns = 5;
  block.host_time_uncertainty_ns = 17;
  block.sequence = 7;
  for (std::size_t scan = 0; scan < 3; ++scan) {
    block.column(0)[scan] = 0.5 + static_cast<double>(scan);
    block.column(1)[scan] = scan == 2 ? kNan : 10.0 + static_cast<double>(scan);
  }
  block.quality(1)[0] = core::quality::kStuck;
  block.quality(1)[2] = core::quality::kRail;

  EXPECT_EQ(encoder.topic(), "floor/cop");
  EXPECT_EQ(text(encoder.encode(block, 11, 13)),
            "instance_id: 42 segment: 2 first_scan: 1000 scan_count: 3 channel_count: 2 rate { numerator: 1500 denominator: 1 } "
            "host_time_ns: 5 sequence: 7 lost_scans_total: 11 dropped_blocks_total: 13 values: [0.5, 1.5, 2.5, 10, 11, nan] "
            "quality: \"\\000\\003\" host_time_uncertainty_ns: 17");
}

}  // namespace
}  // namespace dts::ipc
