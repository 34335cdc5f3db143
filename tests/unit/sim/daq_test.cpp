// SPDX-License-Identifier: Apache-2.0
#include "sim/daq.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace dts::sim {
namespace {

double converted(const Daq& daq, double volts, std::uint64_t scan = 0) {
  std::array<double, 1> value = {volts};
  daq.convert(value, scan);
  return value[0];
}

TEST(Daq, NoNoise_NearestCodeWithinTheRange) {
  const Daq daq({5.0, 11, 0.0, 1});
  const double step = daq.step_v();

  EXPECT_DOUBLE_EQ(step, 10.0 / 2048);  // the thesis's rig
  EXPECT_EQ(daq.minimum_v(), -5.0);
  EXPECT_DOUBLE_EQ(daq.maximum_v(), 5.0 - 10.0 / 2048);
  EXPECT_EQ(converted(daq, 0.0), 0.0);
  EXPECT_DOUBLE_EQ(converted(daq, 100.4 * step), 100 * step);
  EXPECT_DOUBLE_EQ(converted(daq, 100.6 * step), 101 * step);
  EXPECT_DOUBLE_EQ(converted(daq, -100.6 * step), -101 * step);
  EXPECT_EQ(converted(daq, 7.0), daq.maximum_v());
  EXPECT_EQ(converted(daq, 5.0), daq.maximum_v());
  EXPECT_EQ(converted(daq, -7.0), daq.minimum_v());
}

TEST(Daq, Noise_HasTheWantedSizeAndNoMean) {
  const Daq daq({5.0, 16, 3e-3, 1});
  double sum = 0.0;
  double sum_of_squares = 0.0;
  constexpr int kScans = 20'000;
  for (std::uint64_t scan = 0; scan < kScans; ++scan) {
    const double deviation = converted(daq, 1.0, scan) - 1.0;
    sum += deviation;
    sum_of_squares += deviation * deviation;
  }

  EXPECT_NEAR(sum / kScans, 0.0, 5 * 3e-3 / std::sqrt(kScans));
  EXPECT_NEAR(std::sqrt(sum_of_squares / kScans), 3e-3, 0.03 * 3e-3);
}

TEST(Daq, Noise_IndependentBetweenChannelsAndScans) {
  const Daq daq({5.0, 16, 3e-3, 1});
  std::array<double, 3> before{};
  std::array<double, 4> products{};
  constexpr int kScans = 20'000;
  for (std::uint64_t scan = 0; scan < kScans; ++scan) {
    std::array<double, 3> values{};
    daq.convert(values, scan);
    products[0] += values[0] * values[1];
    products[1] += values[1] * values[2];
    products[2] += values[0] * before[0];
    products[3] += values[0] * before[2];
    before = values;
  }

  for (const double product : products) EXPECT_LT(std::abs(product / kScans), 5 * 9e-6 / std::sqrt(kScans));
}

TEST(Daq, SameScanAsked_SameNoise) {
  const Daq daq({5.0, 16, 3e-3, 1});
  const Daq other_seed({5.0, 16, 3e-3, 2});

  EXPECT_EQ(converted(daq, 1.0, 77), converted(daq, 1.0, 77));
  EXPECT_NE(converted(daq, 1.0, 77), converted(daq, 1.0, 78));
  EXPECT_NE(converted(daq, 1.0, 77), converted(other_seed, 1.0, 77));
}

}  // namespace
}  // namespace dts::sim
