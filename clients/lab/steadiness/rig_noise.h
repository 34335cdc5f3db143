// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "posturography/measure.h"
#include "posturography/prepare.h"

namespace dts::lab::steadiness {

/// The white noise of a rig's centre of pressure, and what it does to the measures of a trial from a quieter plate. A table has measures,
/// not samples, so this is computed from the spectrum of the noise after the filter of the profile; the tests compare it with samples that
/// noise was added to. The effect on entropies and on quantiles of spectra depends on the samples: with_noise leaves these measures out.
class RigNoise {
 public:
  /// `noise_mm`: SD of one scan, in each axis, at `scan_hz`. `rate_hz`: rate of the analysed series.
  RigNoise(double noise_mm, double scan_hz, double rate_hz, posturography::Profile profile) noexcept;

  [[nodiscard]] static bool is_known_for(posturography::Measure measure) noexcept;
  /// Returns the measures with noise; only those of `is_known_for` that can be computed.
  [[nodiscard]] posturography::Measures added_to(const posturography::Measures& measures) const noexcept;

  [[nodiscard]] double variance_mm2() const noexcept { return variance_mm2_; }
  [[nodiscard]] double velocity_variance() const noexcept { return velocity_variance_; }

 private:
  double density_ = 0.0;            ///< mm2/Hz, one axis, before the filter.
  double variance_mm2_ = 0.0;       ///< Of one axis, after the filter.
  double velocity_variance_ = 0.0;  ///< (mm/s)2, of the steps of the analysed series times their rate, one axis.
};

}  // namespace dts::lab::steadiness
