// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/cop_least_squares.h"

#include <Eigen/Dense>
#include <limits>
#include <utility>

namespace dts::physics {
namespace {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Below this, the fit passes through the row whatever its value, so the other rows cannot check it.
constexpr double kSmallestFreedom = 1e-6;

std::vector<double> flat(const Rows& matrix) { return {matrix.data(), matrix.data() + matrix.size()}; }

}  // namespace

core::Result<LeastSquaresSolution> solve(const LeastSquares& problem) {
  const auto rows = static_cast<Eigen::Index>(problem.row_count());
  const auto columns = static_cast<Eigen::Index>(problem.column_count);
  const auto target_count = static_cast<Eigen::Index>(problem.target_count);
  const Eigen::Index ridge_rows = problem.ridge.empty() ? 0 : columns;
  Rows system = Rows::Zero(rows + ridge_rows, columns);
  Rows targets = Rows::Zero(rows + ridge_rows, target_count);
  system.topRows(rows) = Eigen::Map<const Rows>(problem.system.data(), rows, columns);
  targets.topRows(rows) = Eigen::Map<const Rows>(problem.targets.data(), rows, target_count);
  for (Eigen::Index k = 0; k < ridge_rows; ++k) system(rows + k, k) = std::sqrt(problem.ridge[static_cast<std::size_t>(k)]);

  const Eigen::RowVectorXd lengths = system.colwise().norm();
  if (lengths.size() > 0 && lengths.minCoeff() > 0.0) system.array().rowwise() /= lengths.array();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(problem.rank_threshold);
  qr.compute(system);
  if (rows < columns || qr.rank() < columns) {
    return refuse_calibration(
        std::to_string(rows) + " samples determine only " + std::to_string(qr.rank()) + " of " + std::to_string(columns) + " coefficients",
        "spread the positions over the area between the sensors");
  }
  Rows solution = qr.solve(targets);
  const Eigen::MatrixXd orthogonal = qr.householderQ() * Eigen::MatrixXd::Identity(system.rows(), columns);
  const Eigen::VectorXd freedom = 1.0 - orthogonal.topRows(rows).rowwise().squaredNorm().array();
  const Rows residual = (targets - system * solution).topRows(rows);
  Rows left_out = targets.topRows(rows);
  for (Eigen::Index row = 0; row < rows; ++row) {
    if (freedom(row) < kSmallestFreedom) {
      left_out.row(row).setConstant(std::numeric_limits<double>::quiet_NaN());
    } else {
      left_out.row(row) -= residual.row(row) / freedom(row);
    }
  }
  solution.array().colwise() /= lengths.transpose().array();
  return LeastSquaresSolution{flat(solution), flat(left_out)};
}

tl::unexpected<core::Error> refuse_calibration(const std::string& what, std::string hint) {
  return core::fail(core::ErrorCode::InvalidArgument, "centre-of-pressure calibration: " + what, std::move(hint));
}

}  // namespace dts::physics
