// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "posturography/measure.h"

namespace dts::pattern {

/// A measure as input of a discriminant: its logarithm if it was above 0 in every training row, minus the mean, divided by the SD.
struct Predictor {
  posturography::Measure measure{};
  bool is_logarithmic = false;
  double mean = 0.0;
  double sd = 1.0;     ///< Above 0.
  double least = 0.0;  ///< Range of the measure itself in training.
  double most = 0.0;
};

/// Linear discriminant: the likelihood of class k is proportional to exp(offset_k + weights_k z), with z the standardised predictors.
struct Discriminant {
  std::vector<std::string> classes;  ///< Sorted.
  std::vector<Predictor> predictors;
  std::vector<std::vector<double>> weights;  ///< [class][predictor]
  std::vector<double> offsets;               ///< [class]
  double shrinkage = 0.0;                    ///< 0..1, of the covariance towards a multiple of the identity.
};

/// The prediction of a discriminant for one row.
struct Answer {
  std::optional<std::size_t> best;              ///< Index of the class; empty: a measure is missing or has no logarithm.
  std::vector<double> probabilities;            ///< One per class; empty without `best`.
  std::vector<posturography::Measure> outside;  ///< Measures outside the training range: the prediction is a guess.
  std::vector<posturography::Measure> missing;  ///< Measures that are absent or have no logarithm.
};

/// Thread: any.
[[nodiscard]] Answer classify(const Discriminant& discriminant, const posturography::Measures& measures);

/// Returns exp(score) / sum of exp(score), without overflow. A score may be -infinity; then its probability is 0. Returns nothing if a
/// score is NaN or infinite, or all are -infinity.
[[nodiscard]] std::vector<double> probabilities_of(std::vector<double> scores);

}  // namespace dts::pattern
