// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "core/result.h"
#include "physics/cop/cop_estimator.h"

// Internal to CopEstimator::fit: from samples to the coefficients of a form.

namespace dts::physics {

/// Coefficients, and the estimate of each sample by a fit without that sample.
struct CopFit {
  CopForm form;
  CopValidity validity;
  std::vector<CopEstimate> left_out;  ///< One per sample; empty if the method has too few samples for the check.
};

/// Checks the samples and fits. Fails as CopEstimator::fit, but does not check the misfit yet.
[[nodiscard]] core::Result<CopFit> fit_cop(CopMethod method, std::span<const CopSample> samples);

/// For four floor sensors: Poly3, Thesis, ThesisPerPair. The samples must have been checked.
[[nodiscard]] core::Result<CopFit> fit_floor(CopMethod method, std::span<const CopSample> samples, const CopValidity& validity);
/// The samples must have been checked.
[[nodiscard]] core::Result<CopFit> fit_moment(std::span<const CopSample> samples, const CopValidity& validity);

/// Returns the estimator of a fit. Fails if the fit misses its own samples: then their positions or the order of the sensors are wrong.
[[nodiscard]] core::Result<CopEstimator> accept(CopMethod method, CopFit fitted, std::span<const CopSample> samples);

inline constexpr auto kSensorOrderHint =
    "check the positions, and that the sensors are in the order w1 left back, w2 right back, w3 left front, w4 right front";

/// A feature may leave the calibrated range by this fraction of the range: noise at the border of the calibrated area is not extrapolation.
inline constexpr double kCopMargin = 0.01;
/// The calibration is valid this far beyond its lightest and heaviest load: plate-model 5.2 and its study found less than 0.9 mm error
/// within 20 % of a single calibration load on the stiffening plate.
inline constexpr double kCopLoadMargin = 0.2;
/// Positions closer than this are the same position; a point may also lie this far from a mid-line.
inline constexpr double kSamePositionMm = 1.0;

[[nodiscard]] double sum_of(const CopSample& sample) noexcept;

/// Returns the range of a feature over the samples, widened by `kCopMargin` of the range on both sides.
template <class Feature>
[[nodiscard]] Interval calibrated_range(std::span<const CopSample> samples, Feature feature) {
  Interval range{feature(samples.front()), feature(samples.front())};
  for (const CopSample& sample : samples) {
    const double value = feature(sample);
    range.lowest = value < range.lowest ? value : range.lowest;
    range.highest = value > range.highest ? value : range.highest;
  }
  const double margin = kCopMargin * (range.highest - range.lowest);
  return {range.lowest - margin, range.highest + margin};
}

}  // namespace dts::physics
