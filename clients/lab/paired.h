// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lab/alignment.h"
#include "lab/recording.h"

namespace dts::lab {

/// Values of both recordings at the same instants: the scans of the slower one, the other interpolated. All columns equally long.
struct Paired {
  std::vector<double> t_a_s;  ///< On A's clock.
  std::vector<double> a_x, a_y, b_x, b_y;
};

/// Instants at which one of the values is missing are left out.
[[nodiscard]] Paired pair_up(const Recording& a, const Recording& b, const Alignment& alignment);

/// Of both axes together, as the search for the lag takes it; 0 when one recording does not move or too little is in common.
[[nodiscard]] double correlation(const Paired& paired);

}  // namespace dts::lab
