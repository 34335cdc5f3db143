// SPDX-License-Identifier: Apache-2.0
#include "lab/training/fits.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "classifier/trunk_model_form.h"

namespace dts::lab::training {
namespace {

using Eigen::Index;

/// Returns 1, x_i, x_i x_j with i <= j, as in classifier::Quadratic.
Eigen::VectorXd quadratic_terms(std::span<const double> row) {
  const std::size_t count = row.size();
  Eigen::VectorXd terms(static_cast<Index>(1 + count + count * (count + 1) / 2));
  Index place = 0;
  terms[place++] = 1.0;
  for (const double value : row) terms[place++] = value;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i; j < count; ++j) terms[place++] = row[i] * row[j];
  }
  return terms;
}

std::span<const double> row_of(const Samples& samples, std::size_t index) {
  return std::span(samples.inputs).subspan(index * samples.input_count, samples.input_count);
}

Index term_count(const Samples& samples) { return static_cast<Index>(classifier::Quadratic::term_count(samples.input_count)); }

double log_likelihood(std::span<const Forecast> forecasts, double temperature) {
  double sum = 0.0;
  for (const auto& [probability, wanted] : forecasts) {
    double total = 0.0;
    for (const double value : probability) total += std::pow(std::max(value, 1e-9), 1.0 / temperature);
    sum += std::log(std::max(probability[wanted], 1e-9)) / temperature - std::log(total);
  }
  return sum;
}

}  // namespace

void Samples::add(std::span<const double> row, double target, double weight) {
  inputs.insert(inputs.end(), row.begin(), row.end());
  targets.push_back(target);
  weights.push_back(weight);
}

std::vector<double> fit_quadratic(const Samples& samples, double ridge) {
  const Index terms = term_count(samples);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(terms, terms);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(terms);
  double total = 0.0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const Eigen::VectorXd row = quadratic_terms(row_of(samples, k));
    normal += samples.weights[k] * row * row.transpose();
    right += samples.weights[k] * samples.targets[k] * row;
    total += samples.weights[k];
  }
  for (Index k = 1; k < terms; ++k) normal(k, k) += ridge * total;
  normal(0, 0) += 1e-12;
  const Eigen::VectorXd solution = normal.ldlt().solve(right);
  return {solution.begin(), solution.end()};
}

std::vector<double> fit_logistic(const Samples& samples, double ridge) {
  constexpr int kMostNewtonSteps = 50;
  const Index terms = term_count(samples);
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(terms);
  double ones = 0.0;
  double zeros = 0.0;
  for (std::size_t k = 0; k < samples.size(); ++k) (samples.targets[k] > 0.5 ? ones : zeros) += samples.weights[k];
  for (int iteration = 0; iteration < kMostNewtonSteps; ++iteration) {
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Identity(terms, terms) * ridge;
    Eigen::VectorXd slope = -ridge * weights;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const Eigen::VectorXd row = quadratic_terms(row_of(samples, k));
      const double share = 0.5 * samples.weights[k] / (samples.targets[k] > 0.5 ? ones : zeros);
      const double probability = 1.0 / (1.0 + std::exp(-std::clamp(row.dot(weights), -500.0, 500.0)));
      slope += share * (samples.targets[k] - probability) * row;
      hessian += share * probability * (1.0 - probability) * row * row.transpose();
    }
    const Eigen::VectorXd step = hessian.ldlt().solve(slope);
    weights += step;
    if (step.norm() < 1e-10) break;
  }
  return {weights.begin(), weights.end()};
}

double fit_temperature(std::span<const Forecast> forecasts) {
  if (forecasts.empty()) return 1.0;
  double best = 1.0;
  double best_likelihood = log_likelihood(forecasts, 1.0);
  constexpr int kSteps = 100;
  for (int k = 0; k <= kSteps; ++k) {
    const double temperature = 0.25 * std::pow(32.0, static_cast<double>(k) / kSteps);
    const double likelihood = log_likelihood(forecasts, temperature);
    if (likelihood <= best_likelihood) continue;
    best = temperature;
    best_likelihood = likelihood;
  }
  return best;
}

double calibration_error(std::span<const Forecast> forecasts) {
  struct Bin {
    double said = 0.0;
    double right = 0.0;
  };
  std::array<Bin, 10> bins{};
  for (const auto& [probability, wanted] : forecasts) {
    const auto best = std::max_element(probability.begin(), probability.end());
    Bin& bin = bins[std::min(bins.size() - 1, static_cast<std::size_t>(*best * static_cast<double>(bins.size())))];
    bin.said += *best;
    bin.right += static_cast<std::size_t>(best - probability.begin()) == wanted ? 1.0 : 0.0;
  }
  double sum = 0.0;
  for (const Bin& bin : bins) sum += std::abs(bin.said - bin.right);
  return forecasts.empty() ? 0.0 : sum / static_cast<double>(forecasts.size());
}

double conformal_quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(part * static_cast<double>(values.size() + 1)));
  return values[std::min(std::max<std::size_t>(rank, 1), values.size()) - 1];
}

}  // namespace dts::lab::training
