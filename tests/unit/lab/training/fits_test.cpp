// SPDX-License-Identifier: Apache-2.0
#include "lab/training/fits.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "lab/training/random.h"

namespace dts::lab::training {
namespace {

TEST(FitQuadratic, PointsOfAQuadratic_ItsCoefficients) {
  const std::array wanted = {0.3, -1.0, 2.0, 0.5, -0.25, 0.75};  // 1, x, y, xx, xy, yy
  Samples samples{.input_count = 2, .inputs = {}, .targets = {}, .weights = {}};
  Random random(1);
  for (int k = 0; k < 40; ++k) {
    const double x = random.uniform(-1.0, 1.0);
    const double y = random.uniform(-1.0, 1.0);
    samples.add(std::array{x, y}, wanted[0] + wanted[1] * x + wanted[2] * y + wanted[3] * x * x + wanted[4] * x * y + wanted[5] * y * y);
  }

  const auto found = fit_quadratic(samples, 1e-12);

  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) EXPECT_NEAR(found[k], wanted[k], 1e-6);
}

TEST(FitLogistic, TwoHalves_BorderInTheMiddleAndRightSide) {
  Samples samples{.input_count = 1, .inputs = {}, .targets = {}, .weights = {}};
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    const double x = random.uniform(-1.0, 1.0);
    samples.add(std::array{x}, x + random.uniform(-0.2, 0.2) > 0.0 ? 1.0 : 0.0);
  }

  const auto found = fit_logistic(samples, 1e-4);

  ASSERT_EQ(found.size(), 3U);
  EXPECT_GT(found[1], 0.0);
  EXPECT_NEAR(found[0] / found[1], 0.0, 0.1);
}

TEST(FitTemperature, ForecastsTooSure_AboveOne) {
  std::vector<Forecast> forecasts;
  for (int k = 0; k < 100; ++k) forecasts.push_back({{0.98, 0.01, 0.01}, static_cast<std::size_t>(k % 5 == 0 ? 1 : 0)});

  EXPECT_GT(fit_temperature(forecasts), 1.5);
  EXPECT_NEAR(calibration_error(forecasts), 0.18, 1e-9);
}

TEST(ConformalQuantile, HundredValues_TheNinetyFirst) {
  std::vector<double> values;
  for (int k = 1; k <= 100; ++k) values.push_back(static_cast<double>(k));

  EXPECT_EQ(conformal_quantile(values, 0.9), 91.0);
  EXPECT_EQ(conformal_quantile({}, 0.9), 0.0);
  EXPECT_EQ(conformal_quantile({7.0}, 0.9), 7.0);
}

TEST(RandomNumbers, OneSeed_TheSameOnEveryMachine) {
  Random random(42);

  EXPECT_EQ(random.next(), 13679457532755275413ULL);
  EXPECT_EQ(random.next(), 2949826092126892291ULL);
}

}  // namespace
}  // namespace dts::lab::training
