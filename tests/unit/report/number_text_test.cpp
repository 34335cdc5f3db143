// SPDX-License-Identifier: Apache-2.0
#include "report/number_text.h"

#include <gtest/gtest.h>

#include <limits>

#include "report/ticks.h"

namespace dts::report {
namespace {

TEST(NumberText, Significant_HasFourDigits) {
  EXPECT_EQ(significant(304.5930332), "304.6");
  EXPECT_EQ(significant(0.2290261828), "0.2290");
  EXPECT_EQ(significant(8.069575243), "8.070");
  EXPECT_EQ(significant(9.99996), "10.00");
  EXPECT_EQ(significant(-83.67667), "-83.68");
  EXPECT_EQ(significant(123456.7), "123457");
  EXPECT_EQ(significant(1.23456e-7), "1.235e-07");
  EXPECT_EQ(significant(0.0), "0");
}

TEST(NumberText, WhatIsNoNumber_IsADash) {
  EXPECT_EQ(significant(std::numeric_limits<double>::quiet_NaN()), "-");
  EXPECT_EQ(fixed(std::numeric_limits<double>::infinity(), 2), "-");
}

TEST(NumberText, Fixed_HasNoNegativeZero) {
  EXPECT_EQ(fixed(-0.001, 2), "0.00");
  EXPECT_EQ(fixed(-0.01, 2), "-0.01");
  EXPECT_EQ(fixed(1e300, 0).size(), 301U);
}

TEST(NumberText, Utc_IsWrittenOut) {
  EXPECT_EQ(utc_text(0), "1970-01-01 00:00:00 UTC");
  EXPECT_EQ(utc_text(1'795'272'325'999'999'999), "2026-11-21 14:45:25 UTC");
  EXPECT_EQ(utc_text(-1), "1969-12-31 23:59:59 UTC");
}

TEST(Ticks, AreRoundAndWithin) {
  const Ticks ticks = round_ticks(-7.3, 7.3, 5);
  EXPECT_EQ(ticks.at, (std::vector<double>{-5.0, 0.0, 5.0}));
  EXPECT_EQ(ticks.label(5.0), "5");
  EXPECT_EQ(round_ticks(0.0, 0.03, 4).label(0.01), "0.01");
}

TEST(Ticks, OfNoRange_AreNone) {
  EXPECT_TRUE(round_ticks(1.0, 1.0, 5).at.empty());
  EXPECT_TRUE(round_ticks(0.0, std::numeric_limits<double>::infinity(), 5).at.empty());
  EXPECT_TRUE(round_ticks(std::numeric_limits<double>::quiet_NaN(), 1.0, 5).at.empty());
}

}  // namespace
}  // namespace dts::report
