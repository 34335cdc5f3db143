// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/result.h"

namespace dts::physics {

/// Finds the coefficients that map every row of `system` to its row of `targets` with least squares. Both are stored row by row.
struct LeastSquares {
  std::size_t column_count = 0;
  std::size_t target_count = 1;
  std::vector<double> system;
  std::vector<double> targets;
  /// Added to the normal equations' diagonal: the summed noise variance of each column. Empty: none.
  std::vector<double> ridge;
  /// Smallest pivot divided by the largest, with columns scaled to length 1; below this threshold the coefficients count as undetermined.
  double rank_threshold = 1e-4;

  [[nodiscard]] std::size_t row_count() const noexcept { return column_count == 0 ? 0 : system.size() / column_count; }
};

struct LeastSquaresSolution {
  std::vector<double> coefficients;  ///< Column by target: `target_count` values for the first column, then the next.
  /// The prediction of each row's targets by a solution without that row; NaN if that solution does not exist.
  std::vector<double> left_out;
};

/// Solves by Householder QR with column pivoting. Fails with InvalidArgument if the rows do not determine the coefficients.
[[nodiscard]] core::Result<LeastSquaresSolution> solve(const LeastSquares& problem);

/// Returns a calibration error: "centre-of-pressure calibration: <what>".
[[nodiscard]] tl::unexpected<core::Error> refuse_calibration(const std::string& what, std::string hint = {});

}  // namespace dts::physics
