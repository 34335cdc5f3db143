// SPDX-License-Identifier: Apache-2.0
#include "posturography/ground_reaction.h"

#include <gtest/gtest.h>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

namespace dts::posturography {
namespace {

constexpr double kSwingRateHz = 100.0;
constexpr double kBodyHeightM = 1.75;
constexpr double kBodyWeightN = 70.0 * 9.81;

/// A centre of pressure that swings with one frequency on each axis.
CopSeries swinging(double ml_hz, double ap_hz, double duration_s = 60.0) {
  CopSeries series{.rate_hz = kSwingRateHz};
  for (std::size_t i = 0; i < static_cast<std::size_t>(duration_s * kSwingRateHz); ++i) {
    const double t = static_cast<double>(i) / kSwingRateHz;
    series.ml_mm.push_back(20.0 + 3.0 * std::sin(2.0 * std::numbers::pi * ml_hz * t));
    series.ap_mm.push_back(-40.0 + 4.0 * std::cos(2.0 * std::numbers::pi * ap_hz * t));
    series.load_n.push_back(kBodyWeightN);
  }
  return series;
}

double amplitude(std::span<const double> values) {
  double squares = 0.0;
  std::size_t count = 0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    squares += value * value;
    ++count;
  }
  return std::sqrt(2.0 * squares / static_cast<double>(count));
}

/// m w0^2 w^2 / (w0^2 + w^2) x amplitude, written down again.
double pendulum_n(double hz, double amplitude_mm) {
  const double w2 = std::pow(2.0 * std::numbers::pi * hz, 2);
  const double w02 = 9.81 / (1.25 * 0.55 * kBodyHeightM);
  return 70.0 * w02 * w2 / (w02 + w2) * amplitude_mm / 1000.0;
}

TEST(GroundReactionTest, OneFrequency_HasThePendulumsForceAgainstTheDisplacement) {
  const CopSeries series = swinging(0.5, 1.0);
  const auto force = ground_reaction(series, kBodyHeightM);
  ASSERT_TRUE(force);
  EXPECT_NEAR(force->mass_kg, 70.0, 1e-9);
  EXPECT_NEAR(force->effective_length_m, 1.203125, 1e-12);
  EXPECT_NEAR(amplitude(force->ml_n), pendulum_n(0.5, 3.0), 0.01 * pendulum_n(0.5, 3.0));
  EXPECT_NEAR(amplitude(force->ap_n), pendulum_n(1.0, 4.0), 0.01 * pendulum_n(1.0, 4.0));
  // The ground pushes back to the middle: forward of it, the force points backwards.
  const std::size_t top = 3050;  // 30.5 s: sin(pi 30.5) > 0, at its largest; cos(2 pi 30.5) = -1
  EXPECT_LT(force->ml_n[top], 0.0);
  EXPECT_GT(force->ap_n[top], 0.0);
}

TEST(GroundReactionTest, OutsideTheBand_IsLeftOut) {
  const auto slow_and_fast = ground_reaction(swinging(0.02, 4.0, 200.0), kBodyHeightM);
  ASSERT_TRUE(slow_and_fast);
  EXPECT_LT(amplitude(slow_and_fast->ml_n), 0.05);
  EXPECT_LT(amplitude(slow_and_fast->ap_n), 0.01 * pendulum_n(4.0, 4.0));
}

TEST(GroundReactionTest, EndsAndGaps_HaveNoResult) {
  CopSeries series = swinging(0.5, 0.5, 80.0);
  series.load_n[4000] = 0.0;  // one sample: bridged
  for (std::size_t i = 5000; i < 5010; ++i) series.ml_mm[i] = std::numeric_limits<double>::quiet_NaN();
  const auto force = ground_reaction(series, kBodyHeightM);
  ASSERT_TRUE(force);
  for (const std::size_t absent : {0U, 299U, 4700U, 5000U, 5309U, 7700U, 7999U}) EXPECT_TRUE(std::isnan(force->ml_n[absent])) << absent;
  for (const std::size_t present : {300U, 4000U, 4699U, 5310U, 7699U}) EXPECT_TRUE(std::isfinite(force->ap_n[present])) << present;
  EXPECT_EQ(force->supported, 4400U + 2390U);
}

TEST(GroundReactionTest, NoiseOfAnEmptyPlate_IsNoPartOfTheMass) {
  CopSeries series = swinging(0.5, 0.5, 80.0);
  for (std::size_t i = 0; i < 3000; ++i) {
    series.ml_mm[i] = std::numeric_limits<double>::quiet_NaN();
    series.load_n[i] = 1.0;
  }
  const auto force = ground_reaction(series, kBodyHeightM);
  ASSERT_TRUE(force);
  EXPECT_NEAR(force->mass_kg, 70.0, 1e-9);
  EXPECT_NEAR(force->load_sd_n, 0.0, 1e-3);
  series.load_n.assign(series.load_n.size(), std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(ground_reaction(series, kBodyHeightM)) << "no load where somebody stands";
}

TEST(GroundReactionTest, ShortStretchesOrWrongValues_AreRejectedWithTheReason) {
  EXPECT_FALSE(ground_reaction(swinging(0.5, 0.5, 25.9), kBodyHeightM));
  EXPECT_TRUE(ground_reaction(swinging(0.5, 0.5, 26.0), kBodyHeightM));
  EXPECT_FALSE(ground_reaction(swinging(0.5, 0.5), 175.0)) << "cm instead of m";
  EXPECT_FALSE(ground_reaction(swinging(0.5, 0.5), std::numeric_limits<double>::quiet_NaN()));
  CopSeries without_load = swinging(0.5, 0.5);
  without_load.load_n.clear();
  const auto rejected = ground_reaction(without_load, kBodyHeightM);
  ASSERT_FALSE(rejected);
  EXPECT_NE(rejected.error().what.find("load_n"), std::string::npos);
  CopSeries torn = swinging(0.5, 0.5);
  torn.ap_mm.pop_back();
  EXPECT_FALSE(ground_reaction(torn, kBodyHeightM));
}

}  // namespace
}  // namespace dts::posturography
