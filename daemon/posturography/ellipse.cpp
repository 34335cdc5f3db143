// SPDX-License-Identifier: Apache-2.0
#include "posturography/ellipse.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dts::posturography {
namespace {

/// A determinant below this fraction of s_xx s_yy is the rounding error of N sums: the points are on a line.
constexpr double kRoundingOfDeterminant = 1e-13;
constexpr double kOutside = 0.05;

bool is_covariance(const Covariance& covariance) noexcept {
  return std::isfinite(covariance.ml_ml) && std::isfinite(covariance.ml_ap) && std::isfinite(covariance.ap_ap) && covariance.ml_ml >= 0.0 &&
         covariance.ap_ap >= 0.0;
}

double determinant(const Covariance& covariance) noexcept {
  const double product = covariance.ml_ml * covariance.ap_ap;
  const double value = product - covariance.ml_ap * covariance.ml_ap;
  return value <= kRoundingOfDeterminant * product && std::isfinite(product) ? 0.0 : value;
}

/// Returns 2 (N-1)(N+1) / (N (N-2)) F_0.95(2, N-2). With two numerator degrees of freedom F is elementary: (v/2) (0.05^(-2/v) - 1), so
/// neither a table nor a statistics library is needed. expm1 keeps its digits if v is large and the power is close to 1.
double factor_of(std::size_t samples) noexcept {
  const auto n = static_cast<double>(samples);
  return (n * n - 1.0) / n * std::expm1(-2.0 / (n - 2.0) * std::log(kOutside));
}

double angle_deg(const Covariance& covariance) noexcept {
  // Adding 0 turns -0 into 0; with -0, atan2 would return -90 instead of 90 degrees.
  const double twice = std::atan2(2.0 * covariance.ml_ap + 0.0, covariance.ml_ml - covariance.ap_ap);
  return 0.5 * twice * 180.0 / std::numbers::pi;
}

}  // namespace

std::optional<PredictionEllipse> prediction_ellipse(const Covariance& covariance, std::size_t samples) noexcept {
  if (samples < 3 || !is_covariance(covariance)) return std::nullopt;
  const double half_difference = 0.5 * (covariance.ml_ml - covariance.ap_ap);
  const double larger = 0.5 * (covariance.ml_ml + covariance.ap_ap) + std::hypot(half_difference, covariance.ml_ap);
  const double det = determinant(covariance);
  // Uses det / larger, because the difference of two nearly equal numbers would lose digits.
  const double smaller = larger > 0.0 ? std::min(det / larger, larger) : 0.0;

  PredictionEllipse ellipse;
  ellipse.sd1_mm = std::sqrt(larger);
  ellipse.sd2_mm = std::sqrt(smaller);
  ellipse.angle_deg = angle_deg(covariance);
  ellipse.factor = factor_of(samples);
  ellipse.area_mm2 = std::numbers::pi * ellipse.factor * std::sqrt(det);
  if (!std::isfinite(ellipse.area_mm2) || !std::isfinite(ellipse.sd1_mm)) return std::nullopt;
  return ellipse;
}

}  // namespace dts::posturography
