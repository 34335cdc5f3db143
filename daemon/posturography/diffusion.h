// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "posturography/measure.h"
#include "posturography/prepare.h"

namespace dts::posturography {

/// Mean-square displacement as a function of lag, over all overlapping pairs.
struct DisplacementCurve {
  double lag_step_s = 0.0;     ///< Time between two samples.
  std::vector<double> ap_mm2;  ///< [k]: lag of k samples; [0] is 0.
  std::vector<double> ml_mm2;  ///< Same length; the planar curve is the sum.
};
/// Computes the curve up to `max_lag_s`, at most half the record. Thread: any.
[[nodiscard]] DisplacementCurve mean_square_displacement(const Prepared& prepared, double max_lag_s = 10.0);

/// Adds MSD at 0.1 to 10 s (where the lag is at most T/2). With `with_diffusion`, also adds the stabilogram diffusion (Collins & De Luca
/// 1993): half the slope of MSD, half the log-log slope over 0 < tau <= 0.5 s and 2 <= tau <= 10 s on a 10 ms grid, and the critical time
/// at which the two lines cross, if D_S > D_L and the time is within 0 .. 10 s. Section 5 of the sheet requires D_S > 2 D_L, but its
/// section 10 prints a value below that; such a value is kept and flagged (`kUnclearCriticalPoint`).
void add_random_walk(const Prepared& prepared, const DisplacementCurve& curve, bool with_diffusion, Measures& measures);

}  // namespace dts::posturography
