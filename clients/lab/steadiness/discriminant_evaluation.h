// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "lab/steadiness/discriminant_fit.h"
#include "lab/steadiness/left_out_people.h"
#include "pattern/pattern_model.h"

namespace dts::lab::steadiness {

using pattern::Interval;
using pattern::Verdict;

/// Other facts of the people that might predict the label as well: "age".
struct Rival {
  std::string name;
  std::vector<std::vector<double>> columns;  ///< [column][row]; a fact in words has several columns of 0 and 1.
};

/// How well one set of inputs predicts the label of people left out. AUC of more than two classes: the mean of each against the rest.
struct Contest {
  std::string name;  ///< "16 measures", "SAMPEN_AP_20HZ", "age"
  Interval auc;      ///< Of people: the probabilities of one person's trials are averaged. Interval: bootstrap over people.
  double auc_trials = 0.5;
  double equal_error_correct = 0.5;
  double brier = 0.0;
  std::optional<double> slope{};
  Interval gain{};  ///< AUC of the model minus this AUC, on the same people.
};

/// The test of one scheme of leaving people out.
struct LeftOutTest {
  std::string scheme;  ///< "leave one out" or "10 x 10-fold"
  Contest model;
  Contest best;                    ///< The best measure alone, chosen in each fold.
  std::string best_measure;        ///< Chosen by most folds,
  std::size_t best_chosen_by = 0;  ///< by so many
  std::size_t folds = 0;           ///< of so many.
  std::vector<Contest> rivals;
};

/// How well the discriminant predicts the labels of left-out people.
struct Evaluation {
  std::vector<std::string> classes;
  std::vector<std::vector<std::size_t>> confusion;  ///< [true class][predicted class; last column: no prediction], leave one out.
  std::size_t rows = 0;
  std::size_t correct = 0;
  std::size_t rows_without = 0;  ///< Rows without a subject: each was left out alone; other rows of the same person may have been used for
                                 ///< training.
  People people{};
  double accuracy = 0.0;
  double balanced_accuracy = 0.0;         ///< Mean over classes of the correct fraction.
  double commonest_share = 0.0;           ///< Accuracy if the most common class is always predicted.
  double brier_base = 0.0;                ///< Brier score if the share of each class is always predicted.
  LeftOutTest left_out;                   ///< Leave one out.
  std::optional<LeftOutTest> ten_fold{};  ///< Only if the AUC of `left_out` is below 0.65, where leave one out is biased downwards.
  double permutation_p = 1.0;
  std::vector<std::string> definitions{};  ///< Rivals that give every label without error: they define it, and are not compared.
  bool is_age_excluded = false;            ///< Age cannot explain the label: it was compared, it defines the label, or every person has
                                           ///< rows of each class.
  Verdict verdict = Verdict::NotTold;
  std::string told_by{};

  /// Returns the test that the verdict is based on.
  [[nodiscard]] const LeftOutTest& deciding() const noexcept { return ten_fold ? *ten_fold : left_out; }
  [[nodiscard]] bool is_of_too_few() const noexcept { return people.named < kFewestSubjects; }
  /// Returns whether the model is better than its best measure alone.
  [[nodiscard]] bool is_better_than_one_measure() const noexcept { return deciding().best.gain.low > 0.0; }

  static constexpr std::size_t kFewestSubjects = 10;
  static constexpr double kMostP = 0.01;
};

/// Leaves out each subject in turn, fits the rest (including choice of measures, logarithms and scaling), and predicts the labels of the
/// left-out subject. With more than 200 subjects, leaves out several at a time. Compares with the best measure alone and with `rivals`,
/// each alone and all together. A label is never told without the rival "age", unless every person has rows of each class. The same input
/// gives the same result on every machine. Fails as `fit` on all rows.
[[nodiscard]] core::Result<Evaluation> evaluate_left_out(const Samples& samples, const std::vector<Rival>& rivals,
                                                         const std::function<void(double)>& progress);

/// Returns the figures of the deciding test, as the model keeps them.
[[nodiscard]] pattern::Figures figures_of(const Evaluation& evaluation);

}  // namespace dts::lab::steadiness
