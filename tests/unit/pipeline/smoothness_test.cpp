// SPDX-License-Identifier: Apache-2.0
#include "pipeline/reach/smoothness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "unit/pipeline/reaching_signal.h"

namespace dts::pipeline {
namespace {

constexpr double kSignalHz = 100.0;

std::unique_ptr<TransientHistory> history_of(const std::vector<double>& mm) {
  auto history = std::make_unique<TransientHistory>();
  for (const double value : mm) history->push(value);
  return history;
}

double smoothness_of(const std::vector<double>& mm) {
  const auto history = history_of(mm);
  return spectral_arc_length(*history, 1, history->now(), kSignalHz);
}

/// `rises` rises of least jerk one after the other, each of `duration_s`.
std::vector<double> rising(int rises, double duration_s, double height_mm) {
  std::vector<double> mm(static_cast<std::size_t>(rises * duration_s * kSignalHz) + 1);
  for (std::size_t i = 0; i < mm.size(); ++i) {
    for (int k = 0; k < rises; ++k) mm[i] += height_mm * MadeReach::smooth(static_cast<double>(i) / kSignalHz / duration_s - k);
  }
  return mm;
}

/// By the authors' own program a movement of least jerk has -1.41 (its duration hardly matters).
TEST(SpectralArcLength, MovementOfLeastJerk_HasTheKnownValueWhateverItsSize) {
  EXPECT_NEAR(smoothness_of(rising(1, 1.0, 2.0)), -1.41, 0.05);
  EXPECT_NEAR(smoothness_of(rising(1, 0.6, 2.0)), -1.41, 0.05);
  EXPECT_NEAR(smoothness_of(rising(1, 1.0, 0.1)), smoothness_of(rising(1, 1.0, 10.0)), 1e-9);
}

TEST(SpectralArcLength, SubMovements_MakeItLess) {
  EXPECT_LT(smoothness_of(rising(2, 0.6, 1.0)), smoothness_of(rising(1, 1.2, 2.0)) - 0.3);
  EXPECT_LT(smoothness_of(rising(4, 0.6, 1.0)), smoothness_of(rising(2, 0.6, 1.0)));
}

/// One jump has all frequencies up to 10 Hz alike: a flat line of length 1. Two, 0.05 s apart, have the spectrum |cos|, which is a half at
/// 6.67 Hz and nothing at 10 Hz.
TEST(SpectralArcLength, Jumps_HaveTheLengthOfTheirSpectrumWhereverTheyAre) {
  for (const std::size_t scan : {1U, 2U, 10U, 18U, 19U}) {
    std::vector<double> mm(20, 3.7);
    std::fill(mm.begin() + static_cast<std::ptrdiff_t>(scan), mm.end(), 4.2);
    EXPECT_NEAR(smoothness_of(mm), -1.0, 1e-9) << scan;
  }
  std::vector<double> twice(20, 1.0);
  std::fill(twice.begin() + 7, twice.end(), 2.0);
  std::fill(twice.begin() + 12, twice.end(), 1.0);
  double length = 0.0;
  for (int k = 1; k <= 96; ++k) {  // the amplitude at 9.6 Hz is the last above 0.05
    const auto amplitude = [](int step) { return std::abs(std::cos(M_PI * 0.1 * step * 0.05)); };
    length += std::hypot(1.0 / 96.0, amplitude(k) - amplitude(k - 1));
  }
  EXPECT_NEAR(smoothness_of(twice), -length, 1e-9);
}

TEST(SpectralArcLength, NothingToMeasure_IsNaN) {
  const auto still = history_of(std::vector<double>(100, 3.7));

  EXPECT_TRUE(std::isnan(spectral_arc_length(*still, 1, 100, kSignalHz)));
  EXPECT_TRUE(std::isnan(smoothness_of({1.0, 2.0, 3.0, 4.0})));
  EXPECT_FALSE(std::isnan(smoothness_of({1.0, 2.0, 3.0, 4.0, 5.0})));
  EXPECT_TRUE(std::isnan(spectral_arc_length(*history_of(rising(1, 0.99, 1.0)), 1, 101, kSignalHz)));
  EXPECT_TRUE(std::isnan(spectral_arc_length(TransientHistory{}, 0, 0, kSignalHz)));
}

}  // namespace
}  // namespace dts::pipeline
