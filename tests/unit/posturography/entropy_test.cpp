// SPDX-License-Identifier: Apache-2.0
#include "posturography/entropy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

namespace dts::posturography {
namespace {

/// The definition, pair by pair.
std::optional<double> naive(const std::vector<double>& values, std::size_t m, double r) {
  const auto count = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  const double tolerance = r * std::sqrt(squares / count);
  std::uint64_t a = 0;
  std::uint64_t b = 0;
  for (std::size_t i = 0; i + m < values.size(); ++i) {
    for (std::size_t j = i + 1; j + m < values.size(); ++j) {
      std::size_t near = 0;
      while (near <= m && std::abs(values[i + near] - values[j + near]) <= tolerance) ++near;
      b += near >= m ? 1U : 0U;
      a += near > m ? 1U : 0U;
    }
  }
  if (a == 0 || b == 0) return std::nullopt;
  return 0.0 - std::log(static_cast<double>(a) / static_cast<double>(b));
}

std::vector<double> smooth_noise(std::size_t length, unsigned seed, double memory) {
  std::mt19937_64 source(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values(length);
  double state = 0.0;
  for (double& value : values) value = state = memory * state + normal(source);
  return values;
}

TEST(SampleEntropy, RandomSeries_IsTheDefinitionToAllDigits) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<double> values = smooth_noise(150 + 17 * seed, seed, 0.05 * seed);
    for (const std::size_t m : {1U, 2U, 3U, 4U}) EXPECT_EQ(sample_entropy(values, m, 0.2), naive(values, m, 0.2)) << seed << " " << m;
    EXPECT_EQ(sample_entropy(values, 2, 5.0), naive(values, 2, 5.0)) << seed;
  }
  const std::vector<double> near = smooth_noise(1200, 3, 0.99);  // its counts come in several chunks
  EXPECT_EQ(sample_entropy(near, 2, 1.0), naive(near, 2, 1.0));
}

TEST(SampleEntropy, ManyTies_IsTheDefinitionToAllDigits) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::vector<double> values = smooth_noise(300, seed, 0.7);
    for (double& value : values) value = std::round(value * (1.0 + seed));
    EXPECT_EQ(sample_entropy(values), naive(values, 2, 0.2)) << seed;
    EXPECT_EQ(sample_entropy(values, 2, 1.0), naive(values, 2, 1.0)) << seed;
  }
}

TEST(SampleEntropy, SomeDistancesEqualToTheTolerance_AllCount) {
  // -4, six times 0, 4: the SD is exactly 2. With r = 2 a step from 0 is just near, one from -4 to 4 is not.
  std::vector<double> values;
  for (int i = 0; i < 64; ++i) values.push_back(i % 8 == 0 ? -4.0 : (i % 8 == 4 ? 4.0 : 0.0));
  std::ranges::shuffle(values, std::mt19937_64(1));
  const double less = std::nextafter(2.0, 0.0);

  EXPECT_EQ(sample_entropy(values, 2, 2.0), naive(values, 2, 2.0));
  EXPECT_EQ(sample_entropy(values, 2, less), naive(values, 2, less));
  EXPECT_NE(sample_entropy(values, 2, 2.0), sample_entropy(values, 2, less));
}

TEST(SampleEntropy, WorkedByHand) {
  // 1 2 1 2 1 3: SD 0.745, tolerance 0.149: only equal values are near. Templates of two that have a third: 12 21 12 21. Equal pairs:
  // 12-12, 21-21, B = 2. Of three: 121 212 121 213: A = 1.
  const std::vector<double> values{1, 2, 1, 2, 1, 3};

  EXPECT_DOUBLE_EQ(sample_entropy(values).value(), std::log(2.0));
}

TEST(SampleEntropy, NotDefined_IsAbsent) {
  EXPECT_EQ(sample_entropy({}), std::nullopt);
  EXPECT_EQ(sample_entropy(std::vector<double>{1.0}), std::nullopt);
  EXPECT_EQ(sample_entropy(std::vector<double>{1.0, 2.0, 3.0}), std::nullopt);
  EXPECT_EQ(sample_entropy(std::vector<double>(300, 1.3)), std::nullopt) << "constant: no SD";
  EXPECT_EQ(sample_entropy(smooth_noise(100, 1, 0.0), 0), std::nullopt);
  EXPECT_EQ(sample_entropy(smooth_noise(100, 1, 0.0), 99), std::nullopt);
  EXPECT_EQ(sample_entropy(smooth_noise(100, 1, 0.0), std::numeric_limits<std::size_t>::max()), std::nullopt);
  EXPECT_EQ(sample_entropy(smooth_noise(100, 1, 0.0), 2, -1.0), std::nullopt);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    std::vector<double> values = smooth_noise(300, 2, 0.5);
    values[17] = bad;
    EXPECT_EQ(sample_entropy(values), std::nullopt);
  }
}

TEST(SampleEntropy, NoMatches_IsAbsent) {
  std::vector<double> rising(50);
  for (std::size_t n = 0; n < rising.size(); ++n) rising[n] = static_cast<double>(n * n);

  EXPECT_EQ(sample_entropy(rising, 2, 1e-6), std::nullopt) << "B = 0";
  EXPECT_EQ(sample_entropy(std::vector<double>{1, 2, 5, 1, 2, 9, 4, 7}, 2, 0.01), std::nullopt) << "A = 0";
}

}  // namespace
}  // namespace dts::posturography
