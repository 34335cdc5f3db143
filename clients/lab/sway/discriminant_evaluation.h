// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/result.h"
#include "lab/sway/discriminant.h"

namespace dts::lab::steadiness {

/// 95 % interval of a share by Wilson's score; `count` need not be whole. {0, 1} of nothing.
struct Interval {
  double low = 0.0;
  double high = 1.0;
};
[[nodiscard]] Interval wilson_interval(double share, double count) noexcept;

/// How well labels are told of people (or, where no subject is given, of rows) that were left out of the training.
struct Evaluation {
  std::vector<std::string> classes;
  std::vector<std::vector<std::size_t>> confusion;  ///< [true class][told class, and last: nothing told]
  std::size_t rows = 0;
  std::size_t correct = 0;
  std::size_t subjects = 0;      ///< Different ones.
  std::size_t rows_without = 0;  ///< Without a subject: each was left out alone, others of the same person may have stayed.
  double accuracy = 0.0;
  double balanced_accuracy = 0.0;   ///< Mean over classes of the correct share.
  double commonest_share = 0.0;     ///< Accuracy of always saying the commonest class.
  bool is_label_of_person = false;  ///< Nobody has two labels: people, not rows, are what the interval counts.
  double independent = 0.0;         ///< What the interval counts.
  Interval interval{};              ///< Of `accuracy`.

  /// Against the commonest class, beyond what the interval leaves open, and on average over the classes.
  [[nodiscard]] bool is_better_than_chance() const noexcept;
  [[nodiscard]] bool is_of_too_few() const noexcept { return subjects < kFewestSubjects; }

  static constexpr std::size_t kFewestSubjects = 10;
};

/// Leaves out each subject in turn, fits the rest (measures, logarithms and scaling too), and tells the labels of who was left out; of more
/// than 200 subjects, several at a time. Fails as `fit` on all rows would.
[[nodiscard]] core::Result<Evaluation> evaluate_left_out(const Samples& samples, const std::function<void(double)>& progress);

}  // namespace dts::lab::steadiness
