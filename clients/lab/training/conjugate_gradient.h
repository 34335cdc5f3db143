// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace dts::lab::training {

/// A function of weights to minimise.
struct Objective {
  std::function<double(std::span<const double> weights)> error;
  std::function<double(std::span<const double> weights, std::span<double> gradient)> gradient;
};

struct StopRules {
  int most_epochs = 1000;
  int most_failures = 6;  ///< Largest number of successive epochs whose validation error is above the best.
  double least_gradient = 1e-6;
};

struct Minimum {
  std::vector<double> weights;  ///< With the best validation error; without a validation, the last ones.
  double error = 0.0;           ///< Final value of the objective.
  int epochs = 0;
};

/// Minimises by Moller's scaled conjugate gradient (1993) with sigma 5e-5 and lambda 5e-7, as in the thesis. `validation` may be empty.
[[nodiscard]] Minimum minimise(const Objective& objective, std::vector<double> weights,
                               const std::function<double(std::span<const double>)>& validation, const StopRules& stop);

}  // namespace dts::lab::training
