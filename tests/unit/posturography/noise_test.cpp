// SPDX-License-Identifier: Apache-2.0
// Noise whose spectrum is known has known measures: white, and pink (1/f), over the band 0.15 to 5 Hz.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "posturography/diffusion.h"
#include "posturography/entropy.h"
#include "posturography/spectrum.h"
#include "unit/posturography/sway_signals.h"

namespace dts::posturography {
namespace {

constexpr double kNoiseHz = 100.0;
constexpr std::size_t kSamples = 6000;
constexpr int kTrials = 12;

/// Sines at every bin up to 12 Hz, power at each as `power_at`, phases by chance: the spectrum is exactly that.
std::vector<double> noise(std::uint32_t seed, double (*power_at)(double hz)) {
  test::Noise random(seed);
  std::vector<double> values(kSamples);
  for (std::size_t m = 1; m < 720; ++m) {
    const double hz = static_cast<double>(m) * kNoiseHz / static_cast<double>(kSamples);
    const double amplitude = std::sqrt(2.0 * power_at(hz) * kNoiseHz / static_cast<double>(kSamples));
    const double phase = 2.0 * std::numbers::pi * random.uniform();
    // cos(a + n b) by the recurrence of a rotation: a cosine each would take most of this test's time
    const double turn = 2.0 * std::numbers::pi * hz / kNoiseHz;
    double real = amplitude * std::cos(phase);
    double imaginary = amplitude * std::sin(phase);
    const double c = std::cos(turn);
    const double s = std::sin(turn);
    for (double& value : values) {
      value += real;
      const double next = real * c - imaginary * s;
      imaginary = real * s + imaginary * c;
      real = next;
    }
  }
  return values;
}

/// Means over trials of the measures of AP.
struct ExpectedOfNoise {
  double power_mm2 = 0.0;
  double cfreq_hz = 0.0;
  double mpf_hz = 0.0;
  double freqd = 0.0;
  double pf50_hz = 0.0;
};

ExpectedOfNoise mean_of_trials(double (*power_at)(double hz)) {
  ExpectedOfNoise mean;
  for (std::uint32_t trial = 0; trial < kTrials; ++trial) {
    Prepared prepared{.rate_hz = kNoiseHz, .ml_mm = std::vector<double>(kSamples), .ap_mm = noise(trial + 1, power_at)};
    Measures measures;
    add_frequency_domain(prepared, multitaper_spectra(prepared), true, measures);
    mean.power_mm2 += measures.get(Measure::PowerAp).value() / kTrials;
    mean.cfreq_hz += measures.get(Measure::CfreqAp).value() / kTrials;
    mean.mpf_hz += measures.get(Measure::MpfAp).value() / kTrials;
    mean.freqd += measures.get(Measure::FreqdAp).value() / kTrials;
    mean.pf50_hz += measures.get(Measure::Pf50Ap).value() / kTrials;
  }
  return mean;
}

TEST(Noise, White_HasTheMomentsOfAFlatBand) {
  const ExpectedOfNoise found = mean_of_trials([](double) { return 1.0; });

  EXPECT_NEAR(found.power_mm2, 4.85, 0.02 * 4.85);
  EXPECT_NEAR(found.mpf_hz, (5.0 + 0.15) / 2.0, 0.02 * 2.575);
  EXPECT_NEAR(found.cfreq_hz, std::sqrt((125.0 - 0.003375) / (3.0 * 4.85)), 0.02 * 2.93);
  EXPECT_NEAR(found.pf50_hz, 2.575, 0.03 * 2.575);
}

TEST(Noise, Pink_HasTheMomentsOfOneOverF) {
  const ExpectedOfNoise found = mean_of_trials([](double hz) { return 1.0 / hz; });

  const double power = std::log(5.0 / 0.15);
  const double mpf = 4.85 / power;
  const double cfreq = std::sqrt((25.0 - 0.0225) / 2.0 / power);
  // The window of the tapers, 0.15 Hz wide, lifts a slope as steep as that of 1/f at 0.15 Hz by some percent.
  EXPECT_NEAR(found.power_mm2, power, 0.05 * power);
  EXPECT_NEAR(found.mpf_hz, mpf, 0.03 * mpf);
  EXPECT_NEAR(found.cfreq_hz, cfreq, 0.03 * cfreq);
  EXPECT_NEAR(found.freqd, std::sqrt(1.0 - mpf * mpf / (cfreq * cfreq)), 0.02);
  EXPECT_NEAR(found.pf50_hz, std::sqrt(5.0 * 0.15), 0.05 * 0.866) << "half of the power lies below the geometric mean of the edges";
}

std::vector<double> normal(std::uint64_t seed, std::size_t count) {
  test::Noise random(seed);
  std::vector<double> values(count);
  for (double& value : values) value = random.normal();
  return values;
}

double variance(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return squares / static_cast<double>(values.size());
}

TEST(Noise, White_EntropyIsThatOfIndependentNormals) {
  // Two of them are within r sigma with probability erf(r / 2), whatever came before.
  EXPECT_NEAR(sample_entropy(normal(3, 4000)).value(), -std::log(std::erf(0.1)), 0.05);
}

TEST(Noise, White_DisplacementIsTwiceTheVarianceAtEveryLag) {
  const Prepared prepared{.rate_hz = kNoiseHz, .ml_mm = normal(4, kSamples), .ap_mm = normal(5, kSamples)};
  const DisplacementCurve curve = mean_square_displacement(prepared);
  for (const std::size_t lag : {std::size_t{1}, std::size_t{10}, std::size_t{100}, std::size_t{1000}}) {
    EXPECT_NEAR(curve.ap_mm2[lag], 2.0 * variance(prepared.ap_mm), 0.12) << lag;  // 4 standard errors
    EXPECT_NEAR(curve.ml_mm2[lag], 2.0 * variance(prepared.ml_mm), 0.12) << lag;
  }
}

}  // namespace
}  // namespace dts::posturography
