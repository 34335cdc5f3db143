// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "posturography/measure.h"
#include "posturography/prepare.h"

namespace dts::posturography {

/// Mean-square displacement against lag: of all overlapping pairs.
struct DisplacementCurve {
  double lag_step_s = 0.0;     ///< Of one sample.
  std::vector<double> ap_mm2;  ///< [k]: lag of k samples; [0] is 0.
  std::vector<double> ml_mm2;  ///< As long; the planar curve is the sum.
};
/// Up to `max_lag_s`, at most half the record. Thread: any.
[[nodiscard]] DisplacementCurve mean_square_displacement(const Prepared& prepared, double max_lag_s = 10.0);

/// MSD at 0.1 to 10 s (where the lag is at most T/2) and, with `with_diffusion`, the stabilogram diffusion (Collins & De Luca 1993): half
/// the slope of MSD, half the log-log slope over 0 < tau <= 0.5 s and 2 <= tau <= 10 s on a 10 ms grid, the critical time: where
/// the two lines cross, if D_S > D_L and it lies in 0 .. 10 s. The sheet's section 5 wants D_S > 2 D_L; its section 10 prints one below: it
/// is told, and flagged (`kUnclearCriticalPoint`).
void add_random_walk(const Prepared& prepared, const DisplacementCurve& curve, bool with_diffusion, Measures& measures);

}  // namespace dts::posturography
