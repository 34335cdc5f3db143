// SPDX-License-Identifier: Apache-2.0
#include "posturography/butterworth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

namespace dts::posturography {
namespace {

/// A noisy ramp, the same on every machine and in the script that gave the reference values.
std::vector<double> noisy_ramp(std::size_t samples) {
  std::vector<double> values;
  std::uint64_t random = 12345;
  for (std::size_t i = 0; i < samples; ++i) {
    random = random * 48271 % 2147483647;
    values.push_back(50.0 + static_cast<double>(random % 4096) / 256.0 + 0.5 * static_cast<double>(i));
  }
  return values;
}

/// b0..b4, a0..a4 of both sections as one.
struct DirectForm {
  std::array<double, 5> b{};
  std::array<double, 5> a{};
};
DirectForm multiplied(const LowPass& sections) {
  const std::array<double, 3> b1{sections[0].b0, sections[0].b1, sections[0].b2};
  const std::array<double, 3> b2{sections[1].b0, sections[1].b1, sections[1].b2};
  const std::array<double, 3> a1{1.0, sections[0].a1, sections[0].a2};
  const std::array<double, 3> a2{1.0, sections[1].a1, sections[1].a2};
  DirectForm product;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      product.b[i + k] += b1[i] * b2[k];
      product.a[i + k] += a1[i] * a2[k];
    }
  }
  return product;
}

std::complex<double> response(const LowPass& sections, double frequency_hz, double rate_hz) {
  const std::complex<double> back = std::polar(1.0, -2.0 * std::numbers::pi * frequency_hz / rate_hz);
  std::complex<double> gain = 1.0;
  for (const Section& of : sections) gain *= (of.b0 + back * (of.b1 + back * of.b2)) / (1.0 + back * (of.a1 + back * of.a2));
  return gain;
}

struct Expected {
  std::size_t sample;
  double zero_phase;
  double causal;
};

/// Sample by sample and zero-phase against scipy 1.10: sosfilt(sos, x, zi=sosfilt_zi(sos)*x[0]), sosfiltfilt(sos, x, padtype="odd",
/// padlen=15) with sos = butter(4, 10, fs=rate, output="sos"). scipy's direct form, filtfilt(b, a, x), differs from that by 4e-9 at 1000
/// Hz.
void expect_as_scipy(double rate_hz, const std::vector<Expected>& expected) {
  const LowPass sections = butterworth4(10.0, rate_hz);
  const std::vector<double> values = noisy_ramp(40);
  std::vector<double> zero_phase = values;
  filter_zero_phase(sections, zero_phase);
  CausalLowPass causal(sections);
  causal.settle_at(values[0]);
  std::vector<double> one_by_one;
  for (const double value : values) one_by_one.push_back(causal.step(value));
  for (const Expected& at : expected) {
    EXPECT_NEAR(zero_phase[at.sample], at.zero_phase, 2e-11) << "sample " << at.sample << " at " << rate_hz << " Hz";
    EXPECT_NEAR(one_by_one[at.sample], at.causal, 2e-11) << "sample " << at.sample << " at " << rate_hz << " Hz";
  }
}

TEST(Butterworth, At100Hz_HasTheCoefficientsOfTheSheet) {
  const DirectForm form = multiplied(butterworth4(10.0, 100.0));

  const std::array<double, 5> binomial{1.0, 4.0, 6.0, 4.0, 1.0};
  const std::array<double, 5> a{1.0, -2.36951300718, 2.31398841442, -1.05466540588, 0.187379492368};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(form.b[i], 0.00482434335772 * binomial[i], 1e-13);
    EXPECT_NEAR(form.a[i], a[i], 1e-11);
  }
}

TEST(Butterworth, Gain_IsOneForAConstantAndHalfOfThePowerAtTheCutOff) {
  for (const double rate_hz : {20.5, 25.0, 100.0, 1500.0, 100'000.0}) {
    EXPECT_NEAR(std::abs(response(butterworth4(10.0, rate_hz), 0.0, rate_hz)), 1.0, 1e-15) << rate_hz;
    EXPECT_NEAR(std::norm(response(butterworth4(10.0, rate_hz), 10.0, rate_hz)), 0.5, 1e-9) << rate_hz;
  }
}

TEST(Butterworth, SlowRamp_IsFourSamplesLateAt100Hz) {
  CausalLowPass filter(butterworth4(10.0, 100.0));
  filter.settle_at(0.0);

  double value = 0.0;
  for (int i = 0; i <= 1000; ++i) value = filter.step(i);

  EXPECT_NEAR(1000.0 - value, 4.0, 0.05);  // the sheet
  EXPECT_NEAR(1000.0 - value, lag_near_dc(10.0, 100.0), 1e-9);
  EXPECT_NEAR(lag_near_dc(10.0, 1000.0), 41.58, 0.01);  // the analog prototype: 2.6131 / (2 pi 10 Hz) = 41.59 ms
}

TEST(Butterworth, NoisyRamp_IsFilteredAsByScipy) {
  expect_as_scipy(100.0, {{0, 61.788091239250747, 61.839843750000014},
                          {1, 61.650180960967248, 61.811274591678526},
                          {2, 61.559093191406212, 61.622857944941181},
                          {7, 60.019320672913949, 60.576364770597507},
                          {19, 70.435098624676385, 62.602749457138962},
                          {31, 74.177670192917475, 70.061740335257625},
                          {38, 76.893526063000337, 74.218680646195168},
                          {39, 77.816782069431824, 74.552465018339092}});
  expect_as_scipy(1000.0, {{0, 63.402892807976492, 61.839843750000931},
                           {1, 63.483166036743199, 61.839838429278281},
                           {2, 63.562567840948127, 61.839795536702532},
                           {7, 63.94177175796785, 61.836163501573459},
                           {19, 64.65922474772033, 61.75802032742007},
                           {31, 65.022334905049078, 61.674802988925691},
                           {38, 65.094798425368239, 61.941900061674538},
                           {39, 65.099723746303155, 62.014960928067431}});
}

TEST(Butterworth, Constant_StaysThatConstant) {
  for (const double rate_hz : {100.0, 1000.0, 1500.0}) {
    for (const double constant : {0.0, 123.456789, -1e4}) {
      std::vector<double> values(100, constant);
      filter_zero_phase(butterworth4(10.0, rate_hz), values);
      CausalLowPass causal(butterworth4(10.0, rate_hz));
      causal.settle_at(constant);
      for (std::size_t i = 0; i < 100'000; ++i) ASSERT_NEAR(causal.step(constant), constant, 1e-12 * std::abs(constant)) << rate_hz;
      EXPECT_EQ(values, std::vector<double>(100, constant)) << rate_hz;
    }
  }
}

TEST(Butterworth, TooFewSamplesForThePadding_AreLeftAsTheyAre) {
  const LowPass sections = butterworth4(10.0, 100.0);
  for (std::size_t samples = 0; samples <= kZeroPhasePadding; ++samples) {
    std::vector<double> values = noisy_ramp(samples);
    filter_zero_phase(sections, values);
    EXPECT_EQ(values, noisy_ramp(samples));
  }
  std::vector<double> values = noisy_ramp(kZeroPhasePadding + 1);
  filter_zero_phase(sections, values);
  EXPECT_NE(values, noisy_ramp(kZeroPhasePadding + 1));
}

TEST(Butterworth, StateTakenAway_GoesOnBitForBit) {
  CausalLowPass one(butterworth4(10.0, 100.0));
  one.settle_at(3.0);
  for (const double value : noisy_ramp(17)) (void)one.step(value);
  CausalLowPass other(butterworth4(10.0, 100.0));

  other.set_state(one.state());

  for (const double value : noisy_ramp(20)) EXPECT_EQ(one.step(value), other.step(value));
}

}  // namespace
}  // namespace dts::posturography
