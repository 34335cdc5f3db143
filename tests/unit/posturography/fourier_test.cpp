// SPDX-License-Identifier: Apache-2.0
#include "posturography/fourier.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace dts::posturography {
namespace {

std::vector<Complex> noise(std::size_t length, unsigned seed) {
  std::mt19937_64 source(seed);
  std::normal_distribution<double> normal;
  std::vector<Complex> values(length);
  for (Complex& value : values) value = Complex(normal(source), normal(source));
  return values;
}

/// One bin by the definition; the phase is reduced in whole numbers.
Complex direct_bin(std::span<const Complex> values, std::size_t m) {
  const std::size_t length = values.size();
  std::complex<long double> sum = 0.0L;
  for (std::size_t n = 0; n < length; ++n) {
    const long double phase =
        -2.0L * std::numbers::pi_v<long double> * static_cast<long double>((m * n) % length) / static_cast<long double>(length);
    sum += std::complex<long double>(values[n]) * std::complex<long double>(std::cos(phase), std::sin(phase));
  }
  return Complex(sum);
}

double energy_of(std::span<const Complex> values) {
  double energy = 0.0;
  for (const Complex& value : values) energy += std::norm(value);
  return energy;
}

std::vector<Complex> transformed(std::span<const Complex> values) {
  std::vector<Complex> bins(values.size());
  FourierTransform(values.size()).forward(values, bins);
  return bins;
}

TEST(FourierTransform, EveryShortLength_IsTheDefinition) {
  for (std::size_t length = 1; length <= 40; ++length) {
    const std::vector<Complex> values = noise(length, 7);

    const std::vector<Complex> bins = transformed(values);

    const double scale = std::sqrt(energy_of(values));
    for (std::size_t m = 0; m < length; ++m) EXPECT_LT(std::abs(bins[m] - direct_bin(values, m)), 1e-14 * scale) << length << " " << m;
  }
}

TEST(FourierTransform, LongLength_SomeBinsAreTheDefinitionAndTheEnergyStays) {
  // Smooth, prime, twice a prime, square of a prime, power of two, factors of 13 and 17.
  for (const std::size_t length : {6000U, 5987U, 5998U, 5929U, 4096U, 4913U, 6001U}) {
    const std::vector<Complex> values = noise(length, 3);

    const std::vector<Complex> bins = transformed(values);

    const double energy = energy_of(values);
    EXPECT_NEAR(energy_of(bins) / (static_cast<double>(length) * energy), 1.0, 1e-14) << length;
    for (const std::size_t m : {std::size_t{0}, std::size_t{1}, length / 3, length / 2, length - 1}) {
      EXPECT_LT(std::abs(bins[m] - direct_bin(values, m)), 1e-14 * std::sqrt(energy)) << length << " " << m;
    }
  }
}

TEST(FourierTransform, OnlyLowBinsWanted_TheyAndTheirMirrorsAreTheSame) {
  const std::vector<Complex> values = noise(5987, 8);
  const std::vector<Complex> all = transformed(values);
  std::vector<Complex> some(values.size());

  FourierTransform(values.size(), 300).forward(values, some);

  const double scale = std::sqrt(energy_of(values));
  EXPECT_LT(std::abs(some[0] - all[0]), 1e-13 * scale);
  for (std::size_t m = 1; m <= 300; ++m) {
    EXPECT_LT(std::abs(some[m] - all[m]), 1e-13 * scale);
    EXPECT_LT(std::abs(some[5987 - m] - all[5987 - m]), 1e-13 * scale);
  }
}

TEST(FourierTransform, LongPrimeLength_OneToneIsOneBin) {
  constexpr std::size_t kLength = 30'011;
  constexpr std::size_t kBin = 12'345;
  std::vector<Complex> tone(kLength);
  for (std::size_t n = 0; n < kLength; ++n) {
    const double phase = 2.0 * std::numbers::pi * static_cast<double>((kBin * n) % kLength) / static_cast<double>(kLength);
    tone[n] = Complex(std::cos(phase), std::sin(phase));
  }

  const std::vector<Complex> bins = transformed(tone);

  double rest = 0.0;
  for (std::size_t m = 0; m < kLength; ++m) rest = std::max(rest, std::abs(bins[m] - (m == kBin ? Complex(kLength) : Complex())));
  EXPECT_LT(rest, 1e-13 * kLength);
}

TEST(FourierTransform, WrongSize_NothingIsTouched) {
  const std::vector<Complex> values(5, Complex(1.0));
  std::vector<Complex> bins(4, Complex(7.0));

  FourierTransform(5).forward(values, bins);

  EXPECT_EQ(bins[0], Complex(7.0));
}

TEST(Unpacked, TwoRealSeries_EachHasItsOwnTransform) {
  for (const std::size_t length : {std::size_t{12}, std::size_t{17}}) {
    const std::vector<Complex> both = noise(length, 9);
    std::vector<Complex> first(length);
    std::vector<Complex> second(length);
    for (std::size_t n = 0; n < length; ++n) {
      first[n] = both[n].real();
      second[n] = both[n].imag();
    }

    const std::vector<Complex> bins = transformed(both);

    for (std::size_t m = 0; m < length; ++m) {
      EXPECT_LT(std::abs(unpacked(bins, m).first - direct_bin(first, m)), 1e-13) << m;
      EXPECT_LT(std::abs(unpacked(bins, m).second - direct_bin(second, m)), 1e-13) << m;
    }
  }
}

TEST(SmoothLength, HasNoFactorAboveFive) {
  EXPECT_EQ(smooth_length(0), 1U);
  EXPECT_EQ(smooth_length(7), 8U);
  EXPECT_EQ(smooth_length(6000), 6000U);
  EXPECT_EQ(smooth_length(11'974), 12'000U);
}

}  // namespace
}  // namespace dts::posturography
