// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/result.h"
#include "lab/compare/alignment.h"

namespace dts::lab::compare {

/// One reading of both clocks at the same instant: of an event, or of a window of the signals.
struct ClockReading {
  double b_s = 0.0;
  double late_s = 0.0;  ///< A's reading minus B's.
  double sd_s = 0.0;    ///< Standard deviation of `late_s`.
};

/// Fits one drift, and one offset for each piece between two restarts of a clock, to readings in order of time. Robust: readings far off
/// the others are left out. Fails with Failed without readings.
[[nodiscard]] core::Result<Alignment> fit_clocks(const std::vector<ClockReading>& readings, const Restarts& restarts);

}  // namespace dts::lab::compare
