// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/result.h"
#include "lab/steadiness/discriminant.h"

namespace dts::lab::steadiness {

/// 95 % interval of a fraction by Wilson's score; `count` need not be an integer. {0, 1} if `count` is 0.
struct Interval {
  double low = 0.0;
  double high = 1.0;
};
[[nodiscard]] Interval wilson_interval(double share, double count) noexcept;

/// How well the discriminant predicts the labels of left-out people (or of left-out rows if no subject is known).
struct Evaluation {
  std::vector<std::string> classes;
  std::vector<std::vector<std::size_t>> confusion;  ///< [true class][predicted class; last column: no prediction]
  std::size_t rows = 0;
  std::size_t correct = 0;
  std::size_t subjects = 0;      ///< Number of different subjects.
  std::size_t rows_without = 0;  ///< Rows without a subject: each was left out alone; other rows of the same person may have been used for
                                 ///< training.
  double accuracy = 0.0;
  double balanced_accuracy = 0.0;   ///< Mean over classes of the correct fraction.
  double commonest_share = 0.0;     ///< Accuracy if the most common class is always predicted.
  bool is_label_of_person = false;  ///< No subject has two labels: the interval counts people, not rows.
  double independent = 0.0;         ///< The count that the interval uses.
  Interval interval{};              ///< Of `accuracy`.

  /// Returns whether the accuracy is above the most common class's share by more than the interval, and also on average over the classes.
  [[nodiscard]] bool is_better_than_chance() const noexcept;
  [[nodiscard]] bool is_of_too_few() const noexcept { return subjects < kFewestSubjects; }

  static constexpr std::size_t kFewestSubjects = 10;
};

/// Leaves out each subject in turn, fits the rest (including measures, logarithms and scaling), and predicts the labels of the left-out
/// subject. With more than 200 subjects, leaves out several at a time. Fails as `fit` on all rows.
[[nodiscard]] core::Result<Evaluation> evaluate_left_out(const Samples& samples, const std::function<void(double)>& progress);

}  // namespace dts::lab::steadiness
