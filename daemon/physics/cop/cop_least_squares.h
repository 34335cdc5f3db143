// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/result.h"

namespace dts::physics {

/// Find the coefficients that take every row of `system` to its row of `targets`, in the least squares sense. Both are row by row.
struct LeastSquares {
  std::size_t column_count = 0;
  std::size_t target_count = 1;
  std::vector<double> system;
  std::vector<double> targets;
  /// Added to the normal equations' diagonal: the summed noise variance of each column. Empty: none.
  std::vector<double> ridge;
  /// Smallest over largest pivot, of columns scaled to length 1, below which the coefficients count as undetermined.
  double rank_threshold = 1e-4;

  [[nodiscard]] std::size_t row_count() const noexcept { return column_count == 0 ? 0 : system.size() / column_count; }
};

struct LeastSquaresSolution {
  std::vector<double> coefficients;  ///< Column by target: `target_count` values for the first column, then the next.
  /// What each row's targets would be by a solution found without that row; NaN when it cannot be found without.
  std::vector<double> left_out;
};

/// By Householder QR with column pivoting. Fails with InvalidArgument when the rows do not determine the coefficients.
[[nodiscard]] core::Result<LeastSquaresSolution> solve(const LeastSquares& problem);

/// The error of a calibration: "centre-of-pressure calibration: <what>".
[[nodiscard]] tl::unexpected<core::Error> refuse_calibration(const std::string& what, std::string hint = {});

}  // namespace dts::physics
