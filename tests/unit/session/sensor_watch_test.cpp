// SPDX-License-Identifier: Apache-2.0
#include "session/sensor_watch.h"

#include <gtest/gtest.h>

#include <vector>

namespace dts::session {
namespace {

namespace quality = core::quality;

/// A scan of two sensors with these quality bits.
core::Block scan_of(std::uint8_t first, std::uint8_t second) {
  core::Block block(2, 1);
  block.set_count(1);
  block.quality(0)[0] = first;
  block.quality(1)[0] = second;
  return block;
}

TEST(SensorWatch, ReportsWhatEveryScanOfAPeriodHad) {
  SensorWatch watch(2, 3);
  watch.add(scan_of(quality::kStuck | quality::kUntared, quality::kRail));
  watch.add(scan_of(quality::kStuck, quality::kRail));
  EXPECT_EQ(watch.latest().sensor_count, 0U) << "the period is not over";

  watch.add(scan_of(quality::kStuck, 0));

  EXPECT_EQ(watch.latest().sensor_count, 2U);
  EXPECT_EQ(watch.latest().bits[0], quality::kStuck);
  EXPECT_EQ(watch.latest().bits[1], 0);
}

TEST(SensorWatch, NextPeriodStartsAnew) {
  SensorWatch watch(2, 1);
  watch.add(scan_of(0, quality::kRail));
  watch.add(scan_of(quality::kStuck, 0));

  EXPECT_EQ(watch.latest().bits[0], quality::kStuck);
  EXPECT_EQ(watch.latest().bits[1], 0);
}

TEST(SensorWatch, BlockOfAnotherShape_IsIgnored) {
  SensorWatch watch(3, 1);
  watch.add(scan_of(quality::kStuck, quality::kStuck));
  EXPECT_EQ(watch.latest().sensor_count, 0U);
}

TEST(SensorProblems, SensorsThatMeasure_HaveNone) {
  EXPECT_EQ(sensor_problems({.sensor_count = 2, .bits = {0, quality::kUntared | quality::kSubstituted}}, {"ch0", "ch1"}, "check"), "");
  EXPECT_EQ(sensor_problems({}, {"ch0"}, "check"), "") << "no period is over yet";
}

TEST(SensorProblems, EachSensorIsNamedOnceWithItsReason) {
  RecordProperty("requirement", "SIG-7");
  const SensorDoubts doubts{.sensor_count = 4,
                            .bits = {quality::kStuck | quality::kOutOfRange, quality::kOutOfRange, quality::kRail | quality::kOutOfRange,
                                     quality::kStuck | quality::kRail}};
  EXPECT_EQ(sensor_problems(doubts, {"ch0", "ch1", "ch2", "ch3"}, "check plug and supply"),
            "sensors that do not measure: ch0, ch3 (unchanged); ch2 (at the end of the range); ch1 (outside the calibration curve): "
            "check plug and supply");
}

}  // namespace
}  // namespace dts::session
