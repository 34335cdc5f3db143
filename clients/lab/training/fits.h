// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "classifier/network.h"

namespace dts::lab::training {

/// Scaled rows with a number each.
struct Samples {
  std::size_t input_count = 0;
  std::vector<double> inputs;  ///< Row after row.
  std::vector<double> targets;
  std::vector<double> weights;

  void add(std::span<const double> row, double target, double weight = 1.0);
  [[nodiscard]] std::size_t size() const noexcept { return targets.size(); }
};

/// Least squares for classifier::Quadratic, `ridge` (a part of the rows' weight) against coefficients that the data do not determine;
/// the constant is free.
[[nodiscard]] std::vector<double> fit_quadratic(const Samples& samples, double ridge);

/// Logistic regression over the terms of classifier::Quadratic, targets 0 or 1, by Newton's method with a ridge; both targets weigh the
/// same.
[[nodiscard]] std::vector<double> fit_logistic(const Samples& samples, double ridge);

/// Probabilities with the class that was true.
struct Forecast {
  classifier::Network::Outputs probability{};
  std::size_t wanted = 0;
};

/// The temperature, 0.25 to 8, whose probabilities p^(1/T) are the most likely.
[[nodiscard]] double fit_temperature(std::span<const Forecast> forecasts);

/// Expected calibration error over ten bins of the highest probability.
[[nodiscard]] double calibration_error(std::span<const Forecast> forecasts);

/// The smallest value that at least `part` of `values` (plus one unseen: conformal prediction) do not exceed.
[[nodiscard]] double conformal_quantile(std::vector<double> values, double part);

}  // namespace dts::lab::training
