// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "posturography/measure.h"

namespace dts::lab::steadiness {

/// Rows of measures with known labels. All vectors except `measures` have the same length.
struct Samples {
  std::vector<posturography::Measure> measures;  ///< The measures that every row has.
  std::vector<posturography::Measures> values;
  std::vector<std::string> labels;
  std::vector<std::string> subjects;  ///< Empty: unknown subject.
};

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
  std::vector<double> probabilities;            ///< One per class.
  std::vector<posturography::Measure> outside;  ///< Measures outside the training range: the prediction is a guess.
};

/// Linear discriminant analysis (Fisher) of the rows with the indices `rows`. The pooled covariance is shrunk by the rule of Ledoit & Wolf
/// 2004, so that there may be more measures than rows; priors are the frequencies of the classes. Fails with InvalidArgument if there are
/// fewer than two classes, fewer rows than the number of classes plus one, or no measure that varies. Thread: any.
[[nodiscard]] core::Result<Discriminant> fit(const Samples& samples, std::span<const std::size_t> rows);

[[nodiscard]] Answer classify(const Discriminant& discriminant, const posturography::Measures& measures);

}  // namespace dts::lab::steadiness
