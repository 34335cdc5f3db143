// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace dts::accuracy {

/// A centre of pressure over time, evenly sampled, mm. Both have the same length.
struct Locus {
  std::vector<double> ml_mm;
  std::vector<double> ap_mm;
};

/// How well one axis follows the truth.
struct Agreement {
  double offset_mm = 0.0;        ///< Mean of published - true.
  double rmse_mm = 0.0;          ///< Of published - true, nothing removed.
  double centred_rmse_mm = 0.0;  ///< The same with the mean offset removed.
  double gain = 0.0;             ///< Slope of published over true by least squares; NaN when the truth stands still.
  double residual_mm = 0.0;      ///< What remains (rms) when gain and offset are removed: noise, delay, non-linearity.
};

/// Both spans have the same length, at least 1.
[[nodiscard]] Agreement compare(std::span<const double> published_mm, std::span<const double> true_mm);

/// What a therapist reads off a stabilogram.
struct SwayMeasures {
  double path_length_mm = 0.0;  ///< TOTEX of the posturography sheet, section 3.
  double ellipse_mm2 = 0.0;     ///< PEA95-F, section 3.1.
};

/// Without any filter (profile `asis`). At least 3 samples.
[[nodiscard]] SwayMeasures sway_measures(const Locus& locus);

/// Profile `lp10` with analysis at 100 Hz (section 2): filtered at `rate_hz`, then every (rate / 100)th sample. Rates that are
/// no multiple of 100 Hz are not decimated.
[[nodiscard]] SwayMeasures sway_measures_lp10(const Locus& locus, double rate_hz);

}  // namespace dts::accuracy
