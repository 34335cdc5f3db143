// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/steady.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>

namespace dts::ctl {
namespace {

constexpr SteadyLimits kLimits{.window_scans = 100, .drift = 0.01, .noise = 0.1};

/// Feeds `signal(scan)` plus white noise to one channel, through the window filter of three scans that dtsd has.
SteadyDetector fed(const std::function<double(int)>& signal, int scans, double noise, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, noise);
  SteadyDetector detector(1, kLimits);
  double before = normal(random);
  double last = normal(random);
  for (int i = 0; i < scans; ++i) {
    const double now = normal(random);
    const double value = signal(i) + (before + last + now) / 3.0;
    before = last;
    last = now;
    detector.add({&value, 1});
  }
  return detector;
}

TEST(SteadyDetector, WindowNotFull_NoReading) {
  EXPECT_FALSE(fed([](int) { return 1.0; }, 124, 0.005).reading());
  EXPECT_FALSE(fed([](int) { return 1.0; }, 124, 0.005).unrest());
}

TEST(SteadyDetector, WhiteNoise_RestsAlmostAlways) {
  int steady = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) steady += fed([](int) { return 3.0; }, 125, 0.009, seed).reading().has_value() ? 1 : 0;

  EXPECT_GE(steady, 190);
}

TEST(SteadyDetector, Reading_IsMeanAndNoiseOfTheLastWindow) {
  const auto reading = fed([](int i) { return i < 50 ? 7.0 : 3.0; }, 175, 0.009).reading();

  ASSERT_TRUE(reading);
  EXPECT_NEAR(reading->mean[0], 3.0, 5.0 * 0.009 / 10.0);
  EXPECT_NEAR(reading->noise[0], 0.009 / std::sqrt(3.0), 0.002);  // the filter's mean of three
  EXPECT_EQ(reading->scans, 100U);
}

TEST(SteadyDetector, Drift_IsNoRestHoweverNoisy) {
  for (const double noise : {0.0, 0.003, 0.03}) {
    const auto detector = fed([](int i) { return 0.002 * i; }, 125, noise);  // 0.2 per window, 20 times the limit
    EXPECT_FALSE(detector.reading()) << noise;
    ASSERT_TRUE(detector.unrest());
    EXPECT_EQ(detector.unrest()->channel, 0U);
    const std::string text = detector.unrest()->text;
    ASSERT_EQ(text.rfind("drifts by ", 0), 0U) << text;
    EXPECT_NEAR(std::stod(text.substr(10)), 0.2, 0.03) << "100 scans lie between the first and the last part";
  }
}

TEST(SteadyDetector, TheLastOfPuttingDown_IsNoRest) {
  // The last 2 % of the window are still 1.0 below the rest: without care the mean is 0.02 too low.
  EXPECT_FALSE(fed([](int i) { return i < 27 ? 2.0 : 3.0; }, 125, 0.003).reading());
}

TEST(SteadyDetector, MovementThatTheLimitsLetThrough_DoesNotEnterTheMean) {
  const auto reading = fed([](int i) { return i < 20 ? 2.991 : 3.0; }, 125, 0.0).reading();  // within the lead-in

  ASSERT_TRUE(reading);
  EXPECT_NEAR(reading->mean[0], 3.0, 1e-12);
}

TEST(SteadyDetector, Shaking_IsNoRest) {
  const auto detector = fed([](int i) { return i % 2 == 0 ? 2.8 : 3.2; }, 125, 0.0);

  EXPECT_FALSE(detector.reading());
  ASSERT_TRUE(detector.unrest());
  EXPECT_EQ(detector.unrest()->text.rfind("varies by 0.2", 0), 0U) << detector.unrest()->text;
}

TEST(SteadyDetector, OneChannelMoves_NamedAndNoReading) {
  SteadyDetector detector(4, kLimits);
  for (int i = 0; i < 125; ++i) {
    const std::vector<double> scan{1.0, 2.0, 3.0 + 0.01 * i, 3.0 + 0.01 * i};
    detector.add(scan);
  }

  EXPECT_FALSE(detector.reading());
  EXPECT_EQ(detector.unrest()->channel, 2U);
}

/// Quarters of 24 scans that alternate by 0.02: four standard errors of a mean of 8 independent ones beside the limit of 0.01.
TEST(SteadyDetector, DriftThatNoiseExplains_IsRest) {
  for (const auto& [drift, rests] : {std::pair(0.0388, true), {0.0390, false}}) {
    SteadyDetector detector(1, {.window_scans = 96, .drift = 0.01, .noise = 0.1});
    for (int i = 0; i < 120; ++i) {
      const double value = (i < 24 ? 3.0 : 3.0 + drift) + (i % 2 == 0 ? 0.02 : -0.02);
      detector.add({&value, 1});
    }
    EXPECT_EQ(detector.reading().has_value(), rests) << drift;
  }
}

TEST(SteadyDetector, NotANumber_BeginsAnew) {
  SteadyDetector detector(1, kLimits);
  const auto add = [&](double value, int times) {
    for (int i = 0; i < times; ++i) detector.add({&value, 1});
  };

  add(1.0, 124);
  add(std::numeric_limits<double>::quiet_NaN(), 1);
  add(1.0, 124);
  EXPECT_FALSE(detector.reading());
  add(1.0, 1);
  EXPECT_TRUE(detector.reading());
}

}  // namespace
}  // namespace dts::ctl
