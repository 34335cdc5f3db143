// SPDX-License-Identifier: Apache-2.0
#include "accuracy/low_pass.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace dts::accuracy {
namespace {

/// Product of the sections' polynomials: coefficients of the direct form.
std::array<double, 5> product(const std::array<double, 3>& p, const std::array<double, 3>& q) {
  std::array<double, 5> result{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) result[i + j] += p[i] * q[j];
  }
  return result;
}

TEST(Butterworth4, TenHertzAtHundred_HasTheSheetsCoefficients) {
  const auto [first, second] = butterworth4(10.0, 100.0);

  const auto b = product({first.b0, first.b1, first.b2}, {second.b0, second.b1, second.b2});
  const auto a = product({1.0, first.a1, first.a2}, {1.0, second.a1, second.a2});

  // posturography sheet, section 2, check values
  const std::array<double, 5> expected_a = {1.0, -2.36951300718, 2.31398841442, -1.05466540588, 0.187379492368};
  const std::array<double, 5> binomial = {1.0, 4.0, 6.0, 4.0, 1.0};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(b[i], 0.00482434335772 * binomial[i], 1e-13) << i;
    EXPECT_NEAR(a[i], expected_a[i], 1e-11) << i;
  }
}

TEST(Butterworth4, TenHertzAtThousand_HasTheSheetsSmallGain) {
  const auto [first, second] = butterworth4(10.0, 1000.0);

  EXPECT_NEAR(first.b0 * second.b0, 8.98e-07, 0.005e-07);
}

std::vector<double> sine(double frequency_hz, double rate_hz, std::size_t count) {
  std::vector<double> samples;
  for (std::size_t i = 0; i < count; ++i)
    samples.push_back(std::sin(2.0 * std::numbers::pi * frequency_hz * static_cast<double>(i) / rate_hz));
  return samples;
}

TEST(Lp10, TenHertz_IsHalvedWithoutDelay) {
  for (const double rate_hz : {100.0, 1500.0}) {
    const auto samples = sine(10.0, rate_hz, 6000);

    const auto filtered = lp10(samples, rate_hz);

    ASSERT_EQ(filtered.size(), samples.size());
    for (std::size_t i = 2000; i < 4000; ++i) ASSERT_NEAR(filtered[i], 0.5 * samples[i], 1e-6) << rate_hz << " Hz, sample " << i;
  }
}

TEST(Lp10, StraightLine_PassesUnchangedUpToItsEnds) {
  std::vector<double> line;
  for (int i = 0; i < 200; ++i) line.push_back(100.0 + 0.1 * i);

  const auto filtered = lp10(line, 100.0);

  for (std::size_t i = 0; i < line.size(); ++i) EXPECT_NEAR(filtered[i], line[i], 0.02) << i;
}

TEST(Lp10, TooShortToPad_GivesNothing) {
  EXPECT_TRUE(lp10({}, 100.0).empty());
  EXPECT_TRUE(lp10(std::vector<double>(15, 1.0), 100.0).empty());
  EXPECT_EQ(lp10(std::vector<double>(16, 1.0), 100.0).size(), 16U);
}

TEST(EveryNth, StartsWithTheFirst) {
  EXPECT_EQ(every_nth(std::vector<double>{0, 1, 2, 3, 4, 5, 6}, 3), (std::vector<double>{0, 3, 6}));
  EXPECT_EQ(every_nth(std::vector<double>{5, 6}, 1), (std::vector<double>{5, 6}));
  EXPECT_TRUE(every_nth({}, 15).empty());
}

}  // namespace
}  // namespace dts::accuracy
