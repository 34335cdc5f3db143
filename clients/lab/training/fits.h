// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "classifier/network.h"

namespace dts::lab::training {

/// Scaled rows with one target each.
struct Samples {
  std::size_t input_count = 0;
  std::vector<double> inputs;  ///< Row by row.
  std::vector<double> targets;
  std::vector<double> weights;

  void add(std::span<const double> row, double target, double weight = 1.0);
  [[nodiscard]] std::size_t size() const noexcept { return targets.size(); }
};

/// Least squares for classifier::Quadratic. `ridge` (a fraction of the rows' weight) limits coefficients that the data do not determine;
/// the constant term has no ridge.
[[nodiscard]] std::vector<double> fit_quadratic(const Samples& samples, double ridge);

/// Logistic regression over the terms of classifier::Quadratic, targets 0 or 1, by Newton's method with a ridge; both targets have the same
/// total weight.
[[nodiscard]] std::vector<double> fit_logistic(const Samples& samples, double ridge);

/// Predicted probabilities and the true class.
struct Forecast {
  classifier::Network::Outputs probability{};
  std::size_t wanted = 0;
};

/// Returns the temperature T, 0.25 to 8, for which the probabilities p^(1/T) are the most likely.
[[nodiscard]] double fit_temperature(std::span<const Forecast> forecasts);

/// Expected calibration error over ten bins of the highest probability.
[[nodiscard]] double calibration_error(std::span<const Forecast> forecasts);

/// Returns the smallest value that at least the fraction `part` of `values` (plus one unseen value: conformal prediction) does not exceed.
[[nodiscard]] double conformal_quantile(std::vector<double> values, double part);

}  // namespace dts::lab::training
