// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "pattern/discriminant.h"
#include "posturography/measure.h"

namespace dts::lab::steadiness {

/// Rows of numbers with known classes. All inner vectors and `classes` have one item per row.
struct Inputs {
  std::vector<std::vector<double>> columns;  ///< [column][row], finite.
  std::vector<std::size_t> classes;          ///< Below `class_count`.
  std::size_t class_count = 0;
};

/// A column as input of a discriminant, as `pattern::Predictor`.
struct FittedColumn {
  std::size_t column = 0;
  bool is_logarithmic = false;
  double mean = 0.0;
  double sd = 1.0;
  double least = 0.0;
  double most = 0.0;
};

/// A discriminant over columns. A class without a row in the training has the probability 0.
struct Fit {
  std::vector<FittedColumn> columns;
  std::vector<std::vector<double>> weights;  ///< [class][column]
  std::vector<double> offsets;               ///< [class]
  double shrinkage = 0.0;
};

/// Linear discriminant analysis (Fisher) of the rows with the indices `rows`, by the columns `columns`. The pooled covariance is shrunk by
/// the rule of Ledoit & Wolf 2004, so that there may be more columns than rows; priors are the frequencies of the classes. Fails with
/// InvalidArgument if there are fewer than two classes, fewer rows than the number of classes plus one, or no column that varies. Thread:
/// any.
[[nodiscard]] core::Result<Fit> fit(const Inputs& inputs, std::span<const std::size_t> columns, std::span<const std::size_t> rows);

/// Returns the probability of each class for one row; nothing if a logarithm is not defined.
[[nodiscard]] std::vector<double> probabilities(const Fit& fit, const Inputs& inputs, std::size_t row);

/// Rows of measures with known labels. All vectors except `measures` have the same length.
struct Samples {
  std::vector<posturography::Measure> measures;  ///< The measures that every row has.
  std::vector<posturography::Measures> values;
  std::vector<std::string> labels;
  std::vector<std::string> subjects;  ///< Empty: unknown subject.
};

/// Returns the different labels, sorted.
[[nodiscard]] std::vector<std::string> classes_of(const std::vector<std::string>& labels);
/// Returns the labels as indices of `classes`, which has all of them.
[[nodiscard]] std::vector<std::size_t> class_indices(const std::vector<std::string>& labels, const std::vector<std::string>& classes);
/// Returns one column per measure.
[[nodiscard]] Inputs inputs_of(const Samples& samples, const std::vector<std::string>& classes);

/// Returns the discriminant over all rows. Fails as `fit` above.
[[nodiscard]] core::Result<pattern::Discriminant> fit_all(const Samples& samples);

}  // namespace dts::lab::steadiness
