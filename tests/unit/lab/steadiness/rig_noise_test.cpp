// SPDX-License-Identifier: Apache-2.0
#include "lab/steadiness/rig_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "posturography/analysis.h"

namespace dts::lab::steadiness {
namespace {

using posturography::Measure;
using posturography::Measures;
using posturography::Profile;

constexpr double kScanHz = 100.0;

/// A minute of sway: many slow oscillations, slower ones larger.
posturography::CopSeries swaying(unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
  posturography::CopSeries series{.rate_hz = kScanHz};
  series.ml_mm.assign(6000, 0.0);
  series.ap_mm.assign(6000, 0.0);
  for (auto* axis : {&series.ml_mm, &series.ap_mm}) {
    for (double frequency_hz = 0.05; frequency_hz < 3.0; frequency_hz *= 1.13) {
      const double amplitude = (axis == &series.ap_mm ? 1.1 : 0.8) / std::pow(frequency_hz / 0.1 + 1.0, 0.9);
      const double begin = phase(random);
      for (std::size_t k = 0; k < axis->size(); ++k) {
        (*axis)[k] += amplitude * std::sin(2.0 * std::numbers::pi * frequency_hz * static_cast<double>(k) / kScanHz + begin);
      }
    }
  }
  return series;
}

Measures measured(const posturography::CopSeries& series) {
  const auto analysis = posturography::analyse(series, {.preparation = posturography::kReportPreparation});
  EXPECT_TRUE(analysis);
  return analysis ? analysis->measures : Measures();
}

TEST(RigNoise, PredictedMeasures_AreThoseOfSamplesWithNoise) {
  constexpr double kNoiseMm = 0.26;  // of the rig of 100 Hz
  const RigNoise noise(kNoiseMm, kScanHz, kScanHz, Profile::Lp10);
  for (const unsigned seed : {1U, 2U, 3U, 4U}) {
    posturography::CopSeries series = swaying(seed);
    const Measures quiet = measured(series);
    std::mt19937_64 random(seed + 100);
    std::normal_distribution<double> normal(0.0, kNoiseMm);
    for (auto* axis : {&series.ml_mm, &series.ap_mm}) {
      for (double& value : *axis) value += normal(random);
    }
    const Measures noisy = measured(series);
    const Measures predicted = noise.added_to(quiet);
    EXPECT_GT(noisy.get(Measure::MveloAp).value() / quiet.get(Measure::MveloAp).value(), 1.1) << "else this test shows nothing";
    for (std::size_t k = 0; k < posturography::kMeasureCount; ++k) {
      const auto measure = static_cast<Measure>(k);
      EXPECT_EQ(predicted.has(measure), RigNoise::is_known_for(measure));
      if (!RigNoise::is_known_for(measure)) continue;
      const double truth = noisy.get(measure).value();
      const double tolerance = measure == Measure::AreaSw ? 0.12 : 0.05;  // a product of two estimates
      EXPECT_NEAR(predicted.get(measure).value(), truth, tolerance * truth)
          << posturography::info(measure).symbol << ", without noise " << quiet.get(measure).value();
    }
  }
}

TEST(RigNoise, FasterScansOfTheSameNoise_DisturbLess) {
  const RigNoise slow(0.26, 100.0, 100.0, Profile::Lp10);
  const RigNoise fast(0.05, 1500.0, 100.0, Profile::Lp10);
  EXPECT_NEAR(slow.variance_mm2(), 2.0 * 0.26 * 0.26 / 100.0 * 9.4, 0.1 * slow.variance_mm2()) << "about 9.4 Hz wide";
  EXPECT_LT(fast.velocity_variance(), slow.velocity_variance() / 100.0);
  EXPECT_NEAR(RigNoise(0.26, 100.0, 100.0, Profile::AsIs).variance_mm2(), 0.26 * 0.26, 1e-9) << "all of it, without a filter";
}

TEST(RigNoise, AbsentMeasures_StayAbsent) {
  Measures measures;
  measures.set(Measure::Mvelo, 8.0);
  const Measures noisy = RigNoise(0.26, 100.0, 100.0, Profile::Lp10).added_to(measures);
  EXPECT_EQ(noisy.count(), 1U);
}

}  // namespace
}  // namespace dts::lab::steadiness
