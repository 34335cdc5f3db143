// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "lab/alignment.h"
#include "lab/recording.h"

namespace dts::lab {

/// How far B is from A along one axis, or both together (radial).
struct AxisDifference {
  double rmse_mm = 0.0;               ///< As recorded: includes different origins.
  double rmse_mean_removed_mm = 0.0;  ///< Each recording about its own mean over the overlap.
  double mean_difference_mm = 0.0;    ///< B - A.
  double largest_mm = 0.0;            ///< Of the differences as recorded.
  double largest_mean_removed_mm = 0.0;
  double correlation = 0.0;  ///< Pearson; NaN when one does not move.
};

/// Thesis 4.6 and Table 4.2 as a procedure: two instruments that saw the same person.
struct Comparison {
  Alignment alignment;  ///< Of the clocks as recorded.
  double overlap_s = 0.0;
  std::size_t scan_count = 0;  ///< Compared: those of the slower recording, the other is interpolated.
  double correlation = 0.0;    ///< Of both axes together.
  AxisDifference x;
  AxisDifference y;
  double rmse_total_mm = 0.0;  ///< sqrt(x^2 + y^2).
  double rmse_total_mean_removed_mm = 0.0;
};

/// Aligns the recordings and compares them. Fails as `align`, and with Failed when they have less than a second in common.
[[nodiscard]] core::Result<Comparison> compare(const Recording& a, const Recording& b);

}  // namespace dts::lab
