// SPDX-License-Identifier: Apache-2.0
#include "lab/steadiness/scores.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dts::lab::steadiness {

Ranking::Ranking(std::span<const double> scores, const std::vector<bool>& is_positive) {
  std::vector<std::size_t> order(scores.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t index) { return scores[index]; });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool is_tied = k > 0 && scores[order[k]] == scores[order[k - 1]];
    cases_.push_back({.index = order[k], .is_positive = is_positive[order[k]], .is_tied = is_tied});
  }
}

std::optional<double> Ranking::auc(std::span<const double> weights) const {
  double positive = 0.0;
  double negative = 0.0;  // before the present group of equal scores
  double pairs = 0.0;     // with the positive case above
  double tied_positive = 0.0;
  double tied_negative = 0.0;
  const auto close_tie = [&] {
    pairs += tied_positive * (negative + 0.5 * tied_negative);
    positive += tied_positive;
    negative += tied_negative;
    tied_positive = tied_negative = 0.0;
  };
  for (const Case& one : cases_) {
    if (!one.is_tied) close_tie();
    (one.is_positive ? tied_positive : tied_negative) += weights[one.index];
  }
  close_tie();
  if (!(positive > 0.0) || !(negative > 0.0)) return std::nullopt;
  return pairs / (positive * negative);
}

std::optional<double> Ranking::auc() const { return auc(std::vector<double>(cases_.size(), 1.0)); }

double Ranking::equal_error_correct() const {
  const auto positive = static_cast<double>(std::ranges::count(cases_, true, &Case::is_positive));
  const double negative = static_cast<double>(cases_.size()) - positive;
  if (!(positive > 0.0) || !(negative > 0.0)) return 0.5;
  double best = 0.0;
  double missed = 0.0;  // positive cases below the limit
  double right = 0.0;   // negative cases below the limit
  for (const Case& one : cases_) {
    if (!one.is_tied) best = std::max(best, std::min(1.0 - missed / positive, right / negative));
    (one.is_positive ? missed : right) += 1.0;
  }
  return best;
}

std::optional<double> calibration_slope(std::span<const double> probabilities, const std::vector<bool>& is_positive) {
  constexpr double kLeast = 1e-12;
  constexpr int kMostSteps = 100;
  double intercept = 0.0;
  double slope = 1.0;
  for (int step = 0; step < kMostSteps; ++step) {  // Newton's method
    double gradient[2] = {0.0, 0.0};
    double hessian[3] = {0.0, 0.0, 0.0};
    for (std::size_t k = 0; k < probabilities.size(); ++k) {
      const double p = std::clamp(probabilities[k], kLeast, 1.0 - kLeast);
      const double odds = std::log(p / (1.0 - p));
      const double fitted = 1.0 / (1.0 + std::exp(-(intercept + slope * odds)));
      const double error = (is_positive[k] ? 1.0 : 0.0) - fitted;
      const double weight = fitted * (1.0 - fitted);
      gradient[0] += error;
      gradient[1] += error * odds;
      hessian[0] += weight;
      hessian[1] += weight * odds;
      hessian[2] += weight * odds * odds;
    }
    const double determinant = hessian[0] * hessian[2] - hessian[1] * hessian[1];
    if (!(determinant > 1e-12)) return std::nullopt;
    const double change_slope = (hessian[0] * gradient[1] - hessian[1] * gradient[0]) / determinant;
    intercept += (hessian[2] * gradient[0] - hessian[1] * gradient[1]) / determinant;
    slope += change_slope;
    if (!std::isfinite(slope) || std::abs(slope) > 1e3) return std::nullopt;
    if (std::abs(change_slope) < 1e-9) return slope;
  }
  return std::nullopt;
}

}  // namespace dts::lab::steadiness
