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

/// Rows of measures whose label is known. All vectors but `measures` equally long.
struct Samples {
  std::vector<posturography::Measure> measures;  ///< That every row has.
  std::vector<posturography::Measures> values;
  std::vector<std::string> labels;
  std::vector<std::string> subjects;  ///< Empty: not known whose.
};

/// A measure as a discriminant takes it: its logarithm where it was above 0 in every row of training, less the mean, by the SD.
struct Predictor {
  posturography::Measure measure{};
  bool is_logarithmic = false;
  double mean = 0.0;
  double sd = 1.0;     ///< Above 0.
  double least = 0.0;  ///< The range of training, of the measure itself.
  double most = 0.0;
};

/// Linear discriminant: class k is as likely as exp(offset_k + weights_k z), z the standardised predictors.
struct Discriminant {
  std::vector<std::string> classes;  ///< Rising.
  std::vector<Predictor> predictors;
  std::vector<std::vector<double>> weights;  ///< [class][predictor]
  std::vector<double> offsets;               ///< [class]
  double shrinkage = 0.0;                    ///< 0..1 of the covariance towards a multiple of the identity.
};

/// What a discriminant says of a row.
struct Answer {
  std::optional<std::size_t> best;              ///< Of its classes; nothing: a measure is missing, or has no logarithm.
  std::vector<double> probabilities;            ///< Of its classes.
  std::vector<posturography::Measure> outside;  ///< Beyond the range of training: the answer is a guess.
};

/// Linear discriminant analysis (Fisher) with the pooled covariance shrunk by the rule of Ledoit & Wolf 2004, so that more measures than
/// rows do no harm; priors are the classes' shares. Of the rows given by index. InvalidArgument: fewer than two classes, fewer rows than
/// classes and one, or no measure that varies. Thread: any.
[[nodiscard]] core::Result<Discriminant> fit(const Samples& samples, std::span<const std::size_t> rows);

[[nodiscard]] Answer classify(const Discriminant& discriminant, const posturography::Measures& measures);

}  // namespace dts::lab::steadiness
