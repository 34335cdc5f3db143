// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/gap_table.h"

#include <gtest/gtest.h>

#include <fstream>

#include "unit/libdts/fake_daemon.h"

namespace dts::ctl {
namespace {

TEST(GapTable, AtItsLimits_IsRead) {
  const testing::TemporaryDirectory directory;
  const std::string file = directory.path() / "points.csv";
  std::ofstream(file) << "gap_mm,volts\r\n0,-100\r\n1000,100\n";

  const auto readings = read_gap_table(file);

  ASSERT_TRUE(readings) << readings.error().what;
  ASSERT_EQ(readings->size(), 2U);
  EXPECT_EQ(readings->at(0).gap.value, 0.0);
  EXPECT_EQ(readings->at(0).volts.value, -100.0);
  EXPECT_EQ(readings->at(0).row, 2U);
  EXPECT_EQ(readings->at(1).gap.value, 1000.0);
  EXPECT_EQ(readings->at(1).volts.value, 100.0);
  EXPECT_EQ(readings->at(1).row, 3U);
}

TEST(GapTable, LineThatIsTooLong_IsRefusedByItsNumber) {
  const testing::TemporaryDirectory directory;
  const std::string file = directory.path() / "points.csv";
  for (const std::size_t length : {200U, 201U}) {
    std::ofstream(file) << "gap_mm,volts\n1," << std::string(length - 3, '0') << "1\n";
    const auto readings = read_gap_table(file);
    EXPECT_EQ(readings ? "" : readings.error().what, length == 200 ? "" : file + ":2:1: too long");
  }
}

}  // namespace
}  // namespace dts::ctl
