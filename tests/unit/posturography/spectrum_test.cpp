// SPDX-License-Identifier: Apache-2.0
#include "posturography/spectrum.h"
#include "unit/posturography/sway_signals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <random>

namespace dts::posturography {
namespace {

constexpr double kPi = std::numbers::pi;

Prepared prepared_of(std::size_t samples, double rate_hz, const std::function<double(double)>& ap,
                     const std::function<double(double)>& ml) {
  Prepared prepared{.rate_hz = rate_hz};
  for (std::size_t n = 0; n < samples; ++n) {
    prepared.ap_mm.push_back(ap(static_cast<double>(n) / rate_hz));
    prepared.ml_mm.push_back(ml(static_cast<double>(n) / rate_hz));
  }
  test::centre(prepared.ap_mm);
  test::centre(prepared.ml_mm);
  return prepared;
}

double zero(double) { return 0.0; }

std::function<double(double)> tone(double hz, double amplitude_mm) {
  return [=](double t_s) { return amplitude_mm * std::sin(2.0 * kPi * hz * t_s + 0.3); };
}

std::function<double(double)> noise(unsigned seed) {
  return [source = std::mt19937_64(seed), normal = std::normal_distribution<double>()](double) mutable { return normal(source); };
}

Measures measured_spectrally(const Prepared& prepared, bool with_quantiles = true) {
  Measures measures;
  add_frequency_domain(prepared, multitaper_spectra(prepared), with_quantiles, measures);
  return measures;
}

/// G at one bin by the formula of the sheet.
double direct_density(const std::vector<double>& values, double rate_hz, std::size_t m) {
  const auto count = static_cast<double>(values.size());
  double sum = 0.0;
  for (int k = 1; k <= 8; ++k) {
    std::complex<double> bin = 0.0;
    for (std::size_t n = 0; n < values.size(); ++n) {
      const double taper = std::sqrt(2.0 / (count + 1.0)) * std::sin(kPi * k * static_cast<double>(n + 1) / (count + 1.0));
      bin += taper * values[n] * std::polar(1.0, -2.0 * kPi * static_cast<double>(m * n % values.size()) / count);
    }
    sum += std::norm(bin);
  }
  return 2.0 / (8.0 * rate_hz) * sum;
}

TEST(Multitaper, BandEdges_Count) {
  for (const auto& [samples, rate_hz] :
       {std::pair{6000U, 100.0}, {2000U, 100.0}, {1200U, 20.0}, {32000U, 1000.0}, {90000U, 1500.0}, {3330U, 33.3}, {5994U, 33.3}}) {
    const Spectra spectra = multitaper_spectra(prepared_of(samples, rate_hz, noise(1), noise(2)));
    const auto per_hz = static_cast<std::size_t>(std::lround(samples / rate_hz));
    EXPECT_EQ(spectra.ap.first_bin, (15 * per_hz + 99) / 100) << samples;
    EXPECT_EQ(spectra.ap.first_bin + spectra.ap.density_mm2_per_hz.size() - 1, 5 * per_hz) << samples;
    EXPECT_DOUBLE_EQ(spectra.ap.bin_hz, rate_hz / samples);
  }
}

TEST(Multitaper, Density_IsTheFormula) {
  for (const std::size_t samples : {400U, 403U, 401U, 458U}) {  // even, odd and prime
    SCOPED_TRACE(samples);
    Prepared prepared = prepared_of(samples, 20.0, noise(3), noise(4));
    for (double& value : prepared.ml_mm) value *= 1e-4;  // a quiet axis beside a loud one

    const Spectra spectra = multitaper_spectra(prepared);

    std::vector<double> rd;
    for (std::size_t n = 0; n < prepared.size(); ++n) rd.push_back(std::hypot(prepared.ap_mm[n], prepared.ml_mm[n]));
    test::centre(rd);
    for (std::size_t index = 0; index < spectra.ap.density_mm2_per_hz.size(); index += 5) {
      const std::size_t m = spectra.ap.first_bin + index;
      EXPECT_NEAR(spectra.ap.density_mm2_per_hz[index] / direct_density(prepared.ap_mm, 20.0, m), 1.0, 1e-11) << m;
      EXPECT_NEAR(spectra.ml.density_mm2_per_hz[index] / direct_density(prepared.ml_mm, 20.0, m), 1.0, 1e-11) << m;
      EXPECT_NEAR(spectra.rd.density_mm2_per_hz[index] / direct_density(rd, 20.0, m), 1.0, 1e-11) << m;
    }
  }
}

TEST(FrequencyDomain, OneTone_AllMeasuresAreIts) {
  // 2 mm at 1 Hz for 60 s: power 2 mm2, spread over the tapers' bandwidth of 0.15 Hz, symmetrically.
  const Measures measures = measured_spectrally(prepared_of(6000, 100.0, tone(1.0, 2.0), zero));

  EXPECT_NEAR(measures.get(Measure::PowerAp).value(), 2.0, 0.01);
  EXPECT_NEAR(measures.get(Measure::Pf50Ap).value(), 1.0, 0.02);
  EXPECT_NEAR(measures.get(Measure::Pf95Ap).value(), 1.07, 0.02);
  EXPECT_NEAR(measures.get(Measure::CfreqAp).value(), 1.0, 0.01);
  EXPECT_NEAR(measures.get(Measure::MpfAp).value(), 1.0, 0.01);
  EXPECT_LT(measures.get(Measure::FreqdAp).value(), 0.1);
  EXPECT_NEAR(measures.get(Measure::MpfResWelchhalf).value(), 1.0, 1e-9);
  // RD is 2 |sin|: 8 / (3 pi) mm at 2 Hz and 8 / (15 pi) mm at 4 Hz; 6 Hz is out of the band.
  EXPECT_NEAR(measures.get(Measure::PowerRd).value(), 32.0 / kPi / kPi * (1.0 / 9.0 + 1.0 / 225.0), 0.002);
}

TEST(FrequencyDomain, HandMadeSpectrum_QuantilesAreBinsWithoutInterpolation) {
  const Spectrum spectrum{.bin_hz = 0.5, .first_bin = 1, .density_mm2_per_hz = {1.0, 1.0, 1.0, 1.0}};
  Measures measures;
  add_frequency_domain(Prepared{.rate_hz = 10.0}, {.rd = {}, .ap = spectrum, .ml = {}}, true, measures);

  EXPECT_EQ(measures.get(Measure::PowerAp), 2.0);
  EXPECT_EQ(measures.get(Measure::Pf50Ap), 1.0) << "reached exactly at the second bin";
  EXPECT_EQ(measures.get(Measure::Pf95Ap), 2.0);
  EXPECT_EQ(measures.get(Measure::MpfAp), 1.25);
  EXPECT_DOUBLE_EQ(measures.get(Measure::CfreqAp).value(), std::sqrt(7.5 / 4.0));
  EXPECT_DOUBLE_EQ(measures.get(Measure::FreqdAp).value(), std::sqrt(1.0 - 25.0 / (4.0 * 7.5)));
  EXPECT_FALSE(measures.has(Measure::PowerRd));

  Measures of_short_trial;
  add_frequency_domain(Prepared{.rate_hz = 10.0}, {.rd = {}, .ap = spectrum, .ml = {}}, false, of_short_trial);
  EXPECT_FALSE(of_short_trial.has(Measure::Pf50Ap));
  EXPECT_FALSE(of_short_trial.has(Measure::Pf95Ap));
  EXPECT_EQ(of_short_trial.count(), measures.count() - 2);
}

TEST(FrequencyDomain, OneBin_HasNoDispersion) {
  const Spectrum spectrum{.bin_hz = 0.7, .first_bin = 3, .density_mm2_per_hz = {0.1}};
  Measures measures;
  add_frequency_domain(Prepared{.rate_hz = 10.0}, {.rd = spectrum, .ap = {}, .ml = {}}, true, measures);

  EXPECT_NEAR(measures.get(Measure::FreqdRd).value(), 0.0, 1e-7);
  EXPECT_DOUBLE_EQ(measures.get(Measure::CfreqRd).value(), 3 * 0.7);
}

TEST(FrequencyDomain, NothingMoves_PowerIsZeroAndFrequenciesAreAbsent) {
  const Measures measures = measured_spectrally(prepared_of(6000, 100.0, zero, zero));

  EXPECT_EQ(measures.get(Measure::PowerRd), 0.0);
  EXPECT_EQ(measures.get(Measure::PowerAp), 0.0);
  EXPECT_EQ(measures.count(), 3U) << "the three powers";
}

TEST(FrequencyDomain, RoundingOfAConstant_IsNoMovement) {
  Prepared prepared = prepared_of(6000, 100.0, noise(1), noise(2));
  prepared.mean_ap_mm = prepared.mean_ml_mm = 250.0;
  for (double& value : prepared.ap_mm) value *= 1e-13;
  for (double& value : prepared.ml_mm) value = 0.0;

  EXPECT_FALSE(measured_spectrally(prepared).has(Measure::CfreqAp));
  EXPECT_FALSE(measured_spectrally(prepared).has(Measure::MpfResWelchhalf));
}

TEST(FrequencyDomain, OneAxisConstant_OnlyTheOtherHasFrequencies) {
  const Measures measures = measured_spectrally(prepared_of(5987, 100.0, noise(7), zero));

  EXPECT_TRUE(measures.has(Measure::CfreqAp));
  EXPECT_TRUE(measures.has(Measure::CfreqRd));
  EXPECT_FALSE(measures.has(Measure::CfreqMl));
  EXPECT_TRUE(measures.has(Measure::MpfResWelchhalf));
}

TEST(FrequencyDomain, Circle_ResultantDoesNotMove) {
  const Measures measures = measured_spectrally(prepared_of(
      6000, 100.0, [](double t_s) { return 5.0 * std::sin(kPi * t_s); }, [](double t_s) { return 5.0 * std::cos(kPi * t_s); }));

  EXPECT_FALSE(measures.has(Measure::CfreqRd));
  EXPECT_TRUE(measures.has(Measure::CfreqAp));
}

TEST(FrequencyDomain, TooFewSamples_NothingAndNeverNaN) {
  for (std::size_t samples = 0; samples < 60; ++samples) {
    const Prepared prepared = prepared_of(samples, 100.0, noise(8), noise(9));
    const Measures measures = measured_spectrally(prepared);
    EXPECT_EQ(measures.has(Measure::PowerAp), samples >= 20) << samples << ": below 0.2 s no bin lies in the band";
    EXPECT_EQ(measures.has(Measure::MpfResWelchhalf), samples >= 7) << samples;
  }
}

/// Welch by scipy 1.10: f, P = signal.welch(x, 50, "hann", ceil(N/2), floor(ceil(N/2)/2)), then np.trapz, for
/// ap = sin(n^2 / 900) + n / 100, ml = cos(n / 3) 0.5.
TEST(FrequencyDomain, MeanPowerFrequency_IsScipys) {
  for (const auto& [samples, expected_hz] : {std::pair{600U, 3.74050895652745}, std::pair{601U, 2.92301409622241},
                                             std::pair{602U, 2.92301409622241}, std::pair{603U, 2.92422223668798}}) {
    const Prepared prepared = prepared_of(
        samples, 50.0, [](double t_s) { return std::sin(t_s * 50.0 * t_s * 50.0 / 900.0) + t_s / 2.0; },
        [](double t_s) { return 0.5 * std::cos(t_s * 50.0 / 3.0); });

    EXPECT_NEAR(measured_spectrally(prepared).get(Measure::MpfResWelchhalf).value(), expected_hz, 1e-9) << samples;
  }
}

}  // namespace
}  // namespace dts::posturography
