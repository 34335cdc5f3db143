// SPDX-License-Identifier: Apache-2.0
#include "lab/training/conjugate_gradient.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace dts::lab::training {
namespace {

constexpr double kSigma = 5e-5;
constexpr double kLambda = 5e-7;
constexpr double kLargestLambda = 1e100;

double dot(const std::vector<double>& a, const std::vector<double>& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0); }

std::vector<double> moved(const std::vector<double>& from, double step, const std::vector<double>& direction) {
  std::vector<double> to(from);
  for (std::size_t k = 0; k < to.size(); ++k) to[k] += step * direction[k];
  return to;
}

/// Steps as in Moller's paper, with its names: r is the steepest descent, p the direction, delta the curvature along it.
class Descent {
 public:
  Descent(const Objective& objective, std::vector<double> weights)
      : objective_(objective), weights_(std::move(weights)), gradient_(weights_.size()) {
    error_ = objective_.gradient(weights_, gradient_);
    r_ = moved(std::vector<double>(weights_.size(), 0.0), -1.0, gradient_);
    p_ = r_;
  }

  void step() {
    ++steps_;
    const double p_square = dot(p_, p_);
    if (is_success_) find_curvature(p_square);
    double delta = curvature_ + (lambda_ - lambda_bar_) * p_square;
    if (delta <= 0.0) {  // not positive definite here: correct it
      lambda_bar_ = 2.0 * (lambda_ - delta / p_square);
      delta = -delta + lambda_ * p_square;
      lambda_ = lambda_bar_;
    }
    curvature_ = delta;
    const double mu = dot(p_, r_);
    const double alpha = mu / delta;
    auto candidate = moved(weights_, alpha, p_);
    const double candidate_error = objective_.error(candidate);
    const double comparison = 2.0 * delta * (error_ - candidate_error) / (mu * mu);
    is_success_ = comparison >= 0.0;
    if (is_success_) {
      accept(std::move(candidate), mu);
      if (comparison >= 0.75) lambda_ *= 0.25;
    } else {
      lambda_bar_ = lambda_;
    }
    if (!(comparison >= 0.25)) lambda_ = std::min(lambda_ + delta * (1.0 - std::max(comparison, -1e6)) / p_square, kLargestLambda);
  }

  [[nodiscard]] bool is_finished(double least_gradient) const {
    const double square = dot(r_, r_);
    return !std::isfinite(square) || std::sqrt(square) < least_gradient || dot(p_, p_) <= 0.0 || lambda_ >= kLargestLambda;
  }
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
  [[nodiscard]] double error() const { return error_; }

 private:
  void find_curvature(double p_square) {
    const double sigma = kSigma / std::sqrt(p_square);
    std::vector<double> beyond(weights_.size());
    (void)objective_.gradient(moved(weights_, sigma, p_), beyond);
    curvature_ = 0.0;
    for (std::size_t k = 0; k < p_.size(); ++k) curvature_ += p_[k] * (beyond[k] - gradient_[k]) / sigma;
  }

  void accept(std::vector<double> candidate, double mu) {
    weights_ = std::move(candidate);
    error_ = objective_.gradient(weights_, gradient_);
    const auto next = moved(std::vector<double>(weights_.size(), 0.0), -1.0, gradient_);
    lambda_bar_ = 0.0;
    if (steps_ % weights_.size() == 0) {
      p_ = next;
    } else {
      p_ = moved(next, (dot(next, next) - dot(next, r_)) / mu, p_);
    }
    r_ = next;
  }

  const Objective& objective_;
  std::vector<double> weights_;
  std::vector<double> gradient_;
  std::vector<double> r_;
  std::vector<double> p_;
  double error_ = 0.0;
  double curvature_ = 0.0;
  double lambda_ = kLambda;
  double lambda_bar_ = 0.0;
  bool is_success_ = true;
  std::size_t steps_ = 0;
};

}  // namespace

Minimum minimise(const Objective& objective, std::vector<double> weights, const std::function<double(std::span<const double>)>& validation,
                 const StopRules& stop) {
  Descent descent(objective, std::move(weights));
  Minimum minimum{.weights = descent.weights(), .error = descent.error()};
  double best = validation ? validation(minimum.weights) : 0.0;
  int failures = 0;
  while (minimum.epochs < stop.most_epochs && failures < stop.most_failures && !descent.is_finished(stop.least_gradient)) {
    descent.step();
    ++minimum.epochs;
    const double now = validation ? validation(descent.weights()) : 0.0;
    failures = now > best ? failures + 1 : 0;
    if (now > best) continue;
    best = now;
    minimum.weights = descent.weights();
  }
  minimum.error = descent.error();
  return minimum;
}

}  // namespace dts::lab::training
