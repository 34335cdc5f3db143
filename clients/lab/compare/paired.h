// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lab/compare/alignment.h"
#include "lab/compare/recording.h"

namespace dts::lab::compare {

/// Values of both recordings at the same instants: the scans of the slower recording; the other one is interpolated. All columns have the
/// same length.
struct Paired {
  std::vector<double> t_a_s;  ///< On A's clock.
  std::vector<double> a_x, a_y, b_x, b_y;
};

/// Skips instants at which a value is missing.
[[nodiscard]] Paired pair_up(const Recording& a, const Recording& b, const Alignment& alignment);

/// Returns the correlation of both axes together, as the search for the lag uses it; 0 if a recording does not move or the overlap is too
/// short.
[[nodiscard]] double correlation(const Paired& paired);

}  // namespace dts::lab::compare
