// SPDX-License-Identifier: Apache-2.0
#include "record/export/row_text.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace dts::record {
namespace {

template <class Put>
std::string put(Put&& function) {
  std::array<char, kLongestNumber> text{};
  return {text.data(), function(text.data())};
}
std::string seconds(std::int64_t time_ns) {
  return put([&](char* at) { return put_seconds(at, time_ns); });
}
std::string microseconds(std::int64_t time_ns) {
  return put([&](char* at) { return put_microseconds(at, time_ns); });
}
std::string value(double number, ValueType type) {
  return put([&](char* at) { return put_value(at, number, type, "n/a"); });
}

TEST(PutSeconds, NoMoreDecimalsThanNeeded) {
  EXPECT_EQ(seconds(0), "0");
  EXPECT_EQ(seconds(3'000'000'000), "3");
  EXPECT_EQ(seconds(10'000'000), "0.01");
  EXPECT_EQ(seconds(-1), "-0.000000001");
  EXPECT_EQ(seconds(std::numeric_limits<std::int64_t>::min()), "-9223372036.854775808");
}

TEST(PutMicroseconds, SixDecimalsRounded) {
  EXPECT_EQ(microseconds(666'667), "0.000667");
  EXPECT_EQ(microseconds(-400), "0.000000");
  EXPECT_EQ(microseconds(-1'500'000'000), "-1.500000");
  EXPECT_EQ(microseconds(999'999'600), "1.000000");
}

TEST(PutValue, EachTypeInItsShortestForm) {
  EXPECT_EQ(value(static_cast<double>(0.1F), ValueType::Float32), "0.1");
  EXPECT_EQ(value(static_cast<double>(0.1F), ValueType::Double64), "0.10000000149011612");
  EXPECT_EQ(value(100000.0, ValueType::Int32), "100000");
  EXPECT_EQ(value(-128.0, ValueType::Int8), "-128");
  EXPECT_EQ(value(std::numeric_limits<double>::quiet_NaN(), ValueType::Int8), "n/a");
  EXPECT_EQ(value(9.3e18, ValueType::Int64), "9.3e+18");
}

TEST(Cells, TextThatASpreadsheetWouldCompute_GetsAnApostrophe) {
  for (const char* text : {"=1+1", "+1+1", "-1+1", "@x", "-cmd|' /C calc'!A0"}) EXPECT_EQ(tsv_cell(text), std::string("'") + text);
  EXPECT_EQ(tsv_cell("\t=1"), "' =1");
}

TEST(Cells, NumbersAndOtherText_StayAsTheyAre) {
  for (const char* text : {"-1", "-0.25", "-1e-9", "eyes open", "a=b", "n/a", "'x"}) {
    EXPECT_EQ(tsv_cell(text), text);
  }
}

TEST(ToNs, TimesNoClockShows_StayInRange) {
  EXPECT_EQ(to_ns(1.5), 1'500'000'000);
  EXPECT_EQ(to_ns(std::numeric_limits<double>::quiet_NaN()), 0);
  EXPECT_LT(to_ns(-std::numeric_limits<double>::infinity()), 0);
  EXPECT_GT(to_ns(1e300), 9'000'000'000'000'000'000);
}

TEST(NameWithUnit, HasTheUnitOnce_WithoutSpacesAndCapitals) {
  EXPECT_EQ(name_with_unit({.label = "mx_nm", .unit = "N m"}), "mx_nm");
  EXPECT_EQ(name_with_unit({.label = "ml_mm", .unit = "mm"}), "ml_mm");
  EXPECT_EQ(name_with_unit({.label = "Fz", .unit = "N"}), "Fz_n");
  EXPECT_EQ(name_with_unit({.label = "fz"}), "fz");
}

TEST(TimeAxis, StampThatDisagrees_BeginsAnew) {
  TimeAxis axis(100.0, *core::Rate::create(100, 1));
  axis.begin({.segment = 0, .first_scan = {0}, .first_time_s = 100.0});
  EXPECT_EQ(axis.time_ns(3), 30'000'000);

  axis.begin({.segment = 0, .first_scan = {10}, .first_time_s = 100.15});
  EXPECT_EQ(axis.time_ns(0), 150'000'000) << "50 ms later than the index says";

  axis.begin({.segment = 1, .first_scan = {0}, .first_time_s = 101.0});
  EXPECT_EQ(axis.time_ns(1), 1'010'000'000);
}

TEST(TimeAxis, HugeIndices_StayAtTheLargestTime) {
  TimeAxis axis(0.0, core::Rate{});
  axis.begin({.segment = 0, .first_scan = {0}, .first_time_s = 9e9});

  EXPECT_EQ(axis.time_ns(std::numeric_limits<std::size_t>::max() / 2), std::numeric_limits<std::int64_t>::max());
}

}  // namespace
}  // namespace dts::record
