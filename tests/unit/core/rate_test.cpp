// SPDX-License-Identifier: Apache-2.0
#include "core/rate.h"

#include <gtest/gtest.h>

#include <limits>

namespace dts::core {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kDay_ns = 86'400 * kSecond_ns;

TEST(Rate, CreateWithCommonFactor_IsReduced) {
  const Rate rate = Rate::create(3000, 2).value();

  EXPECT_EQ(rate.numerator(), 1500);
  EXPECT_EQ(rate.denominator(), 1);
  EXPECT_EQ(rate, Rate::create(1500, 1).value());
}

TEST(Rate, CreateWithTermOutsideRange_IsRefused) {
  const std::int64_t largest = Rate::kMaxTerm;

  EXPECT_TRUE(Rate::create(largest, 1).has_value());
  EXPECT_TRUE(Rate::create(1, largest).has_value());
  for (const auto& [scans, seconds] :
       {std::pair<std::int64_t, std::int64_t>{0, 1}, {1, 0}, {-1, 1}, {1, -1}, {largest + 1, 1}, {1, largest + 1}}) {
    const auto rate = Rate::create(scans, seconds);
    ASSERT_FALSE(rate.has_value()) << scans << "/" << seconds;
    EXPECT_EQ(rate.error().code, ErrorCode::InvalidArgument);
  }
}

TEST(Rate, FromHz_KeepsMicrohertz) {
  EXPECT_EQ(Rate::from_hz(1500.0).value(), Rate::create(1500, 1).value());
  EXPECT_EQ(Rate::from_hz(0.1).value(), Rate::create(1, 10).value());
  EXPECT_EQ(Rate::from_hz(1e6).value(), Rate::create(1'000'000, 1).value());
  EXPECT_EQ(Rate::from_hz(1e-6).value(), Rate::create(1, 1'000'000).value());
}

TEST(Rate, FromHzOutsideRange_IsRefused) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double hz : {0.0, -1.0, 4e-7, 1'000'001.0, kInfinity, -kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
    const auto rate = Rate::from_hz(hz);
    ASSERT_FALSE(rate.has_value()) << hz;
    EXPECT_EQ(rate.error().code, ErrorCode::InvalidArgument);
    EXPECT_TRUE(rate.error().what.ends_with(" Hz is outside (0, 1000000] Hz")) << rate.error().what;
  }
}

TEST(Rate, DayAt1500Hz_DoesNotDrift) {
  RecordProperty("requirement", "ACQ-9");
  const Rate rate = Rate::create(1500, 1).value();

  EXPECT_EQ(rate.time_ns({0}), 0);
  EXPECT_EQ(rate.time_ns({1}), 666'667);  // 666666.67 rounded
  EXPECT_EQ(rate.time_ns({86'400ULL * 1500}), kDay_ns);
  EXPECT_EQ(rate.time_ns({86'400ULL * 1500 + 1}), kDay_ns + 666'667);
}

TEST(Rate, EndOfRange_IsExactAndThenStays) {
  constexpr std::int64_t kLatest_ns = std::numeric_limits<std::int64_t>::max();
  const Rate slow = Rate::create(1, Rate::kMaxTerm).value();
  const Rate fast = Rate::create(Rate::kMaxTerm, 1).value();

  EXPECT_EQ(slow.time_ns({1}), kLatest_ns);  // 1e12 s do not fit
  EXPECT_EQ(slow.time_ns({std::numeric_limits<std::uint64_t>::max()}), kLatest_ns);
  EXPECT_EQ(fast.time_ns({std::numeric_limits<std::uint64_t>::max()}), 18'446'744'073'709'552);
  EXPECT_EQ(Rate{}.time_ns({9'223'372'036}), 9'223'372'036 * kSecond_ns);
  EXPECT_EQ(Rate{}.time_ns({9'223'372'037}), kLatest_ns);
}

TEST(Rate, ScansInMs_RoundsToNearestAndIsAtLeastOne) {
  const Rate rate = Rate::create(1500, 1).value();

  EXPECT_EQ(rate.scans_in_ms(2.0), 3U);
  EXPECT_EQ(rate.scans_in_ms(20.0), 30U);
  EXPECT_EQ(rate.scans_in_ms(0.9), 1U);
  EXPECT_EQ(rate.scans_in_ms(1.0), 2U);  // 1.5 scans: half away from zero
  EXPECT_EQ(rate.scans_in_ms(0.0), 1U);
  EXPECT_EQ(rate.scans_in_ms(-5.0), 1U);
}

TEST(Rate, ScansInMsOfNonsense_IsBounded) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();

  EXPECT_EQ(Rate{}.scans_in_ms(std::numeric_limits<double>::quiet_NaN()), 1U);
  EXPECT_EQ(Rate{}.scans_in_ms(-kInfinity), 1U);
  EXPECT_EQ(Rate{}.scans_in_ms(kInfinity), static_cast<std::uint64_t>(Rate::kMaxTerm));
  EXPECT_EQ(Rate{}.scans_in_ms(1e300), static_cast<std::uint64_t>(Rate::kMaxTerm));
}

}  // namespace
}  // namespace dts::core
