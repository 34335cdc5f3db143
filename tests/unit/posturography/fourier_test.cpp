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

/// Smooth, prime, twice a prime, square of a prime, power of two, factors of 13 and 17.
class FourierLength : public testing::TestWithParam<std::size_t> {};

TEST_P(FourierLength, SomeBins_AreTheDefinition) {
  const std::vector<Complex> values = noise(GetParam(), 3);

  const std::vector<Complex> bins = transformed(values);

  const double scale = std::sqrt(energy_of(values));
  for (const std::size_t m : {std::size_t{0}, std::size_t{1}, GetParam() / 3, GetParam() / 2, GetParam() - 1}) {
    EXPECT_LT(std::abs(bins[m] - direct_bin(values, m)), 1e-14 * scale) << m;
  }
}

TEST_P(FourierLength, EnergyStays) {
  const std::vector<Complex> values = noise(GetParam(), 4);

  const std::vector<Complex> bins = transformed(values);

  EXPECT_NEAR(energy_of(bins) / (static_cast<double>(GetParam()) * energy_of(values)), 1.0, 1e-14);
}

TEST_P(FourierLength, IsLinear) {
  const std::vector<Complex> first = noise(GetParam(), 5);
  const std::vector<Complex> second = noise(GetParam(), 6);
  const Complex weight(-1.5, 0.25);
  std::vector<Complex> both(first.size());
  for (std::size_t n = 0; n < both.size(); ++n) both[n] = first[n] + weight * second[n];

  const std::vector<Complex> of_first = transformed(first);
  const std::vector<Complex> of_second = transformed(second);
  const std::vector<Complex> of_both = transformed(both);

  const double scale = std::sqrt(energy_of(both));
  for (std::size_t m = 0; m < both.size(); ++m) ASSERT_LT(std::abs(of_both[m] - of_first[m] - weight * of_second[m]), 1e-13 * scale) << m;
}

INSTANTIATE_TEST_SUITE_P(Lengths, FourierLength, testing::Values(6000, 5987, 5998, 5929, 4096, 4913, 6001));

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
