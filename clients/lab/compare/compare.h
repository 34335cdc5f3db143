// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "lab/compare/alignment.h"
#include "lab/compare/paired.h"
#include "lab/compare/recording.h"

namespace dts::lab::compare {

/// Difference between B and A along one axis, or of both axes together (radial).
struct AxisDifference {
  double rmse_mm = 0.0;               ///< As recorded, including different origins.
  double rmse_mean_removed_mm = 0.0;  ///< Each recording relative to its own mean over the overlap.
  double mean_difference_mm = 0.0;    ///< B - A: the bias.
  double lower_limit_mm = 0.0;        ///< Limits of agreement: mean difference -+ 1.96 standard deviations (Bland & Altman 1986).
  double upper_limit_mm = 0.0;
  double largest_mm = 0.0;  ///< Largest difference as recorded.
  double largest_mean_removed_mm = 0.0;
  double correlation = 0.0;  ///< Pearson; NaN if one recording does not move.
};

/// The comparison of thesis 4.6 and Table 4.2: two instruments that measured the same person.
struct Comparison {
  Alignment alignment;     ///< Of the recorded clocks.
  double end_sd_s = 0.0;   ///< Standard deviation of the alignment at the end of the overlap that is further from its reference.
  double delay_a_s = 0.0;  ///< Filter delays that the times are corrected for.
  double delay_b_s = 0.0;
  bool is_simulated = false;  ///< One of the recordings is from a simulator.
  Paired paired;              ///< What was compared, on A's times since its first scan.
  double overlap_s = 0.0;
  std::size_t scan_count = 0;  ///< Number of compared scans: those of the slower recording; the other one is interpolated.
  double correlation = 0.0;    ///< Of both axes together.
  AxisDifference x;
  AxisDifference y;
  double rmse_total_mm = 0.0;  ///< sqrt(x^2 + y^2).
  double rmse_total_mean_removed_mm = 0.0;
};

/// Aligns the recordings and compares them. Fails as `align`, and with Failed if they overlap by less than one second.
[[nodiscard]] core::Result<Comparison> compare(const Recording& a, const Recording& b);

}  // namespace dts::lab::compare
