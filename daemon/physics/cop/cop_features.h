// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>

#include "physics/cop/cop_estimator.h"

// Features of four deflections that calibration and estimation share. Realtime-safe: yes.

namespace dts::physics {

/// Sums over the floor platform's sensors w1 left back, w2 right back, w3 left front, w4 right front.
struct FloorFeatures {
  double sum = 0.0;
  double u = 0.0;  ///< -1 all on the left .. 1 all on the right.
  double v = 0.0;  ///< -1 all at the back .. 1 all in front.

  [[nodiscard]] static FloorFeatures of(std::span<const double> w) noexcept {
    const double left = w[0] + w[2];
    const double right = w[1] + w[3];
    const double sum = left + right;
    return {sum, (right - left) / sum, (w[2] + w[3] - w[0] - w[1]) / sum};
  }
};

using RatioOf = double (*)(std::span<const double>);

/// Returns near over far; infinite if the far side has no deflection: the load then lies beyond the near side.
[[nodiscard]] inline double deflection_ratio(double near_mm, double far_mm) noexcept {
  return far_mm > 0.0 ? near_mm / far_mm : std::numeric_limits<double>::infinity();
}

/// The ratios from which the position is computed, per axis.
struct ThesisRatios {
  std::span<const RatioOf> x;
  std::span<const RatioOf> y;
};

/// Returns the ratios of Thesis (one ratio of pair averages) or ThesisPerPair (two).
[[nodiscard]] const ThesisRatios& ratios_of(CopMethod method) noexcept;

}  // namespace dts::physics
