// SPDX-License-Identifier: Apache-2.0
#include "pipeline/reach/smoothness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "unit/pipeline/reaching_signal.h"

namespace dts::pipeline {
namespace {

constexpr double kSignalHz = 100.0;

/// `rises` rises of least jerk one after the other, each of `duration_s`.
std::unique_ptr<TransientHistory> rising(int rises, double duration_s, double height_mm) {
  auto history = std::make_unique<TransientHistory>();
  const int samples = static_cast<int>(rises * duration_s * kSignalHz) + 1;
  for (int i = 0; i < samples; ++i) {
    double mm = 0.0;
    for (int k = 0; k < rises; ++k) mm += height_mm * MadeReach::smooth(i / kSignalHz / duration_s - k);
    history->push(mm);
  }
  return history;
}

double smoothness_of(const TransientHistory& history) { return spectral_arc_length(history, 1, history.now(), kSignalHz); }

/// By the authors' own program a movement of least jerk has -1.41 (its duration hardly matters).
TEST(SpectralArcLength, MovementOfLeastJerk_HasTheKnownValue) {
  EXPECT_NEAR(smoothness_of(*rising(1, 1.0, 2.0)), -1.41, 0.05);
  EXPECT_NEAR(smoothness_of(*rising(1, 0.6, 2.0)), -1.41, 0.05);
}

TEST(SpectralArcLength, Size_DoesNotMatter) {
  EXPECT_NEAR(smoothness_of(*rising(1, 1.0, 0.1)), smoothness_of(*rising(1, 1.0, 10.0)), 1e-9);
}

TEST(SpectralArcLength, SubMovements_MakeItLess) {
  EXPECT_LT(smoothness_of(*rising(2, 0.6, 1.0)), smoothness_of(*rising(1, 1.2, 2.0)) - 0.3);
  EXPECT_LT(smoothness_of(*rising(4, 0.6, 1.0)), smoothness_of(*rising(2, 0.6, 1.0)));
}

TEST(SpectralArcLength, NothingToMeasure_IsNaN) {
  TransientHistory still;
  for (int i = 0; i < 100; ++i) still.push(3.7);

  EXPECT_TRUE(std::isnan(spectral_arc_length(still, 1, 100, kSignalHz)));
  EXPECT_TRUE(std::isnan(spectral_arc_length(still, 98, 100, kSignalHz)));
  EXPECT_TRUE(std::isnan(spectral_arc_length(still, 1, 101, kSignalHz)));
  EXPECT_TRUE(std::isnan(spectral_arc_length(TransientHistory{}, 0, 0, kSignalHz)));
}

}  // namespace
}  // namespace dts::pipeline
