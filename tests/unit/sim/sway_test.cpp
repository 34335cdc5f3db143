// SPDX-License-Identifier: Apache-2.0
#include "sim/sway.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "unit/sim/sway_measures.h"

namespace dts::sim {
namespace {

using measures::Series;

struct Path {
  Series ml;
  Series ap;
};

Path record(std::uint64_t seed, double duration_s, const SwayModels& models = kTwoFeetSway) {
  Sway sway(seed, models);
  Path path;
  const auto count = static_cast<std::size_t>(duration_s * measures::kRateHz);
  for (std::size_t i = 0; i < count; ++i) {
    const CopPosition cop = sway.at(static_cast<double>(i) / measures::kRateHz);
    path.ml.push_back(cop.ml_mm);
    path.ap.push_back(cop.ap_mm);
  }
  return path;
}

constexpr std::uint64_t kSeeds = 6;

// The ranges are the 5-95 % ranges of healthy young adults with open eyes on firm ground, posturography section 9; per
// axis the sheet prints medians only, so those limits are half and twice the median.
TEST(Sway, OneMinute_IsHealthyQuietStanding) {
  double size = 0.0;
  double velocity = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));

    const Path path = record(seed, 60.0);

    const double rdist = std::hypot(measures::population_sd(path.ml), measures::population_sd(path.ap));
    const double mvelo = measures::mean_velocity(measures::low_pass(path.ml), measures::low_pass(path.ap));
    EXPECT_TRUE(rdist > 3.32 && rdist < 8.69) << rdist;
    EXPECT_TRUE(mvelo > 5.76 && mvelo < 14.9) << mvelo;
    EXPECT_GT(measures::population_sd(path.ap), 4.38 / 2);
    EXPECT_LT(measures::population_sd(path.ap), 4.38 * 2);
    EXPECT_GT(measures::population_sd(path.ml), 2.65 / 2);
    EXPECT_LT(measures::population_sd(path.ml), 2.65 * 2);
    EXPECT_GT(std::max(measures::range(path.ml), measures::range(path.ap)), 0.75 * 15.3);   // RANGE is at least that of an axis
    EXPECT_LT(std::hypot(measures::range(path.ml), measures::range(path.ap)), 1.3 * 35.0);  // and at most the diagonal
    size += rdist / kSeeds;
    velocity += mvelo / kSeeds;
    if (seed > 1) continue;
    const measures::Spectrum ap = measures::spectrum(path.ap);
    const double half_power_hz = ap.power_frequency(0.5);  // median person 0.34 (0.25-0.49), d01 0.22: the model is at the slow end
    const double most_power_hz = ap.power_frequency(0.95);
    EXPECT_TRUE(half_power_hz > 0.15 && half_power_hz < 0.49) << half_power_hz;
    EXPECT_TRUE(most_power_hz > 0.83 && most_power_hz < 1.64) << most_power_hz;
    const double mean_ml = measures::mean(path.ml);
    const double mean_ap = measures::mean(path.ap);
    double covariance = 0.0;
    for (std::size_t i = 0; i < path.ml.size(); ++i) covariance += (path.ml[i] - mean_ml) * (path.ap[i] - mean_ap) / 6000.0;
    // Slow signals: about 20 independent swings in a minute.
    EXPECT_LT(std::abs(covariance), 0.5 * measures::population_sd(path.ml) * measures::population_sd(path.ap));
  }
  EXPECT_NEAR(size, 5.32, 1.0);
  EXPECT_NEAR(velocity, 8.64, 1.0);
}

// Half to once the velocities that separate older adults with falls from those without, 34 and 29 mm/s (Oliveira et al. 2018).
TEST(Sway, OneFoot_IsLargerAndFasterInMlMostAndStaysOnTheFoot) {
  const auto speed = [](const Series& x) { return measures::mean_velocity(measures::low_pass(x), Series(x.size(), 0.0)); };
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Path two = record(seed, 60.0);

    const Path one = record(seed, 60.0, kOneFootSway);

    EXPECT_GT(speed(one.ml), 17.0);
    EXPECT_LT(speed(one.ml), 34.0);
    EXPECT_GT(speed(one.ap), 14.5);
    EXPECT_LT(speed(one.ap), 29.0);
    EXPECT_GT(speed(one.ml) / speed(two.ml), speed(one.ap) / speed(two.ap));
    EXPECT_GT(measures::population_sd(one.ml) + measures::population_sd(one.ap),
              measures::population_sd(two.ml) + measures::population_sd(two.ap));
    EXPECT_LT(measures::range(one.ml), 45.0);
  }
}

TEST(Sway, Acceleration_IsThatOfThePendulumWithThisCop) {
  Sway sway(5);
  std::vector<SwayMotion> path;
  for (int i = 0; i < 60'000; ++i) path.push_back(sway.motion_at(1e-3 * i));

  // x'' = g (x - p) / l with l = 1 m, so x = p + x'' l / g; the slope of x is the integral of x''.
  const double l_over_g = 1.0 / 9.81;
  double velocity_m_per_s = 0.0;
  const auto position_m = [&](const SwayMotion& at) { return at.cop.ap_mm / 1000.0 + l_over_g * at.ap_m_per_s2; };
  const double first_velocity = (position_m(path[1]) - position_m(path[0])) / 1e-3;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    ASSERT_NEAR((position_m(path[i + 1]) - position_m(path[i])) / 1e-3, first_velocity + velocity_m_per_s, 1e-6) << i;
    velocity_m_per_s += 1e-3 * path[i].ap_m_per_s2;
  }
}

TEST(Sway, SameSeed_GivesTheSameDataAsEver) {
  RecordProperty("requirement", "LAB-6");
  Sway seven(7);
  const CopPosition at_once = seven.at(0.0);
  EXPECT_NEAR(at_once.ml_mm, 1.073874076, 1e-6);
  EXPECT_NEAR(at_once.ap_mm, -2.312451828, 1e-6);
  const CopPosition later = seven.at(5.0);
  EXPECT_NEAR(later.ml_mm, -1.928862246, 1e-6);
  EXPECT_NEAR(later.ap_mm, 0.464914692, 1e-6);
  Sway eight(8);
  EXPECT_NE(eight.at(5.0), later);
}

TEST(Sway, Sampled_HasNoStepsBetweenMilliseconds) {
  Sway sway(3);
  CopPosition before = sway.at(0.0);
  double largest = 0.0;
  for (int i = 1; i < 60'000; ++i) {
    const CopPosition now = sway.at(1e-3 * i);
    largest = std::max(largest, std::hypot(now.ml_mm - before.ml_mm, now.ap_mm - before.ap_mm));
    before = now;
  }

  EXPECT_LT(largest, 5.0);  // the command switches on and off: steps of P and D times the swing, a few mm at most
}

TEST(Sway, TenMinutes_DoesNotDriftAndStaysOnTheFeet) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Path path = record(seed, 600.0);
    const auto half = static_cast<std::ptrdiff_t>(path.ap.size() / 2);
    const Series first(path.ap.begin(), path.ap.begin() + half);
    const Series second(path.ap.begin() + half, path.ap.end());

    EXPECT_NEAR(measures::mean(first), 0.0, 3.0);
    EXPECT_NEAR(measures::mean(second), 0.0, 3.0);
    const double growth = measures::population_sd(second) / measures::population_sd(first);
    EXPECT_GT(growth, 0.6);
    EXPECT_LT(growth, 1.6);
    EXPECT_LT(measures::range(path.ap), 100.0);  // a foot's patches are 140 mm apart
    EXPECT_LT(measures::range(path.ml), 60.0);
  }
}

TEST(Sway, OtherSamplingRate_SameSwayAtTheSameInstants) {
  Sway slow(11);
  Sway fast(11);

  for (int i = 0; i <= 1500; ++i) {
    const CopPosition at_fast = fast.at(i / 1500.0);
    if (i % 15 != 0) continue;
    const CopPosition at_slow = slow.at(i / 15 / 100.0);
    EXPECT_NEAR(at_slow.ml_mm, at_fast.ml_mm, 1e-9);
    EXPECT_NEAR(at_slow.ap_mm, at_fast.ap_mm, 1e-9);
  }
}

TEST(Sway, BetweenTwoMillisecondsIsInterpolated_OlderThanTheOldestKnownIsThat) {
  Sway sway(11);
  const CopPosition before = sway.at(0.050);
  const CopPosition quarter = sway.at(0.05025);
  const CopPosition after = sway.at(0.051);
  EXPECT_NEAR(quarter.ap_mm, 0.75 * before.ap_mm + 0.25 * after.ap_mm, 1e-9);
  EXPECT_NEAR(quarter.ml_mm, 0.75 * before.ml_mm + 0.25 * after.ml_mm, 1e-9);
  (void)sway.at(1.0);

  const CopPosition oldest = sway.at(0.2);

  EXPECT_EQ(oldest, sway.at(1.0));
  EXPECT_EQ(sway.at(-1.0), oldest);
}

TEST(SwayAxis, NoiseDoubled_SwayDoubled) {
  SwayModel quiet;
  SwayModel loud;
  loud.noise_nm_per_sqrt_hz = 2.0 * quiet.noise_nm_per_sqrt_hz;
  SwayAxis one(quiet, 5);
  SwayAxis two(loud, 5);

  for (int i = 0; i < 1000; ++i) EXPECT_NEAR(two.next_mm(), 2.0 * one.next_mm(), 1e-9);

  quiet.noise_nm_per_sqrt_hz = 0.0;
  SwayAxis still(quiet, 5);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(still.next_mm(), 0.0);
}

}  // namespace
}  // namespace dts::sim
