// SPDX-License-Identifier: Apache-2.0
#include "core/number_text.h"

#include <gtest/gtest.h>

#include <limits>

namespace dts::core {
namespace {

TEST(NumberText, HasNoExponentWhereAReaderCountsTheZerosEasily) {
  EXPECT_EQ(number_text(0.0), "0");
  EXPECT_EQ(number_text(1e6), "1000000");
  EXPECT_EQ(number_text(1'000'001.0), "1000001");
  EXPECT_EQ(number_text(-0.00001), "-0.00001");
  EXPECT_EQ(number_text(0.1), "0.1");
  EXPECT_EQ(number_text(1e13), "1e+13");
  EXPECT_EQ(number_text(1e-9), "1e-09");
  EXPECT_EQ(number_text(999'999'999.123456), "999999999.123456");
  EXPECT_EQ(number_text(0.000012345678901234567), "0.000012345678901234568");
  EXPECT_EQ(number_text(std::numeric_limits<double>::infinity()), "inf");
}

}  // namespace
}  // namespace dts::core
