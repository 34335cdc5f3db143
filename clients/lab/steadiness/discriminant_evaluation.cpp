// SPDX-License-Identifier: Apache-2.0
#include "lab/steadiness/discriminant_evaluation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

namespace dts::lab::steadiness {
namespace {

constexpr std::size_t kMostFolds = 200;

/// The fold of each row: rows of one subject together, a row without a subject alone.
struct Folds {
  std::vector<std::size_t> of_row;
  std::size_t count = 0;
};

Folds folds_of(const Samples& samples) {
  std::map<std::string, std::size_t> of_subject;
  Folds folds;
  for (const std::string& subject : samples.subjects) {
    std::size_t fold = folds.count;
    if (!subject.empty()) fold = of_subject.try_emplace(subject, folds.count).first->second;
    folds.count = std::max(folds.count, fold + 1);
    folds.of_row.push_back(fold);
  }
  if (folds.count <= kMostFolds) return folds;
  for (std::size_t& fold : folds.of_row) fold %= kMostFolds;
  folds.count = kMostFolds;
  return folds;
}

std::size_t place_of(const std::vector<std::string>& classes, const std::string& label) {
  return static_cast<std::size_t>(std::ranges::lower_bound(classes, label) - classes.begin());
}

/// Fits without the fold and counts its predictions. If the fit fails, there is no prediction, which counts as wrong.
void classify_fold(const Samples& samples, const Folds& folds, std::size_t fold, Evaluation& evaluation) {
  std::vector<std::size_t> others;
  for (std::size_t row = 0; row < folds.of_row.size(); ++row) {
    if (folds.of_row[row] != fold) others.push_back(row);
  }
  const auto discriminant = fit(samples, others);
  for (std::size_t row = 0; row < folds.of_row.size(); ++row) {
    if (folds.of_row[row] != fold) continue;
    const std::size_t wanted = place_of(evaluation.classes, samples.labels[row]);
    std::size_t predicted = evaluation.classes.size();
    if (discriminant) {
      const Answer answer = classify(*discriminant, samples.values[row]);
      if (answer.best) predicted = place_of(evaluation.classes, discriminant->classes[*answer.best]);
    }
    ++evaluation.confusion[wanted][predicted];
  }
}

void count_people(const Samples& samples, Evaluation& evaluation) {
  std::map<std::string, std::set<std::string>> labels_of;
  for (std::size_t row = 0; row < samples.subjects.size(); ++row) {
    if (samples.subjects[row].empty()) {
      ++evaluation.rows_without;
    } else {
      labels_of[samples.subjects[row]].insert(samples.labels[row]);
    }
  }
  evaluation.subjects = labels_of.size();
  evaluation.is_label_of_person =
      !labels_of.empty() && std::ranges::all_of(labels_of, [](const auto& subject) { return subject.second.size() == 1; });
  evaluation.independent =
      static_cast<double>(evaluation.is_label_of_person ? evaluation.subjects + evaluation.rows_without : samples.labels.size());
}

void add_shares(Evaluation& evaluation) {
  std::size_t commonest = 0;
  for (std::size_t k = 0; k < evaluation.classes.size(); ++k) {
    const auto& predicted = evaluation.confusion[k];
    const std::size_t count = std::accumulate(predicted.begin(), predicted.end(), std::size_t{0});
    evaluation.rows += count;
    evaluation.correct += predicted[k];
    commonest = std::max(commonest, count);
    const double share = static_cast<double>(predicted[k]) / static_cast<double>(count);
    evaluation.balanced_accuracy += share / static_cast<double>(evaluation.classes.size());
  }
  evaluation.accuracy = static_cast<double>(evaluation.correct) / static_cast<double>(evaluation.rows);
  evaluation.commonest_share = static_cast<double>(commonest) / static_cast<double>(evaluation.rows);
}

}  // namespace

Interval wilson_interval(double share, double count) noexcept {
  if (!(count > 0.0)) return {};
  constexpr double kZ = 1.959963984540054;  // 97.5 % of the normal distribution
  const double square = kZ * kZ / count;
  const double middle = (share + 0.5 * square) / (1.0 + square);
  const double half = kZ * std::sqrt(share * (1.0 - share) / count + 0.25 * square / count) / (1.0 + square);
  return {.low = std::max(0.0, middle - half), .high = std::min(1.0, middle + half)};
}

bool Evaluation::is_better_than_chance() const noexcept {
  return interval.low > commonest_share && balanced_accuracy > 1.0 / static_cast<double>(classes.size());
}

core::Result<Evaluation> evaluate_left_out(const Samples& samples, const std::function<void(double)>& progress) {
  std::vector<std::size_t> all(samples.labels.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  DTS_TRY_ASSIGN(const auto whole, fit(samples, all));
  Evaluation evaluation{.classes = whole.classes, .confusion = {}};
  evaluation.confusion.assign(evaluation.classes.size(), std::vector<std::size_t>(evaluation.classes.size() + 1));
  const Folds folds = folds_of(samples);
  for (std::size_t fold = 0; fold < folds.count; ++fold) {
    progress(static_cast<double>(fold) / static_cast<double>(folds.count));
    classify_fold(samples, folds, fold, evaluation);
  }
  count_people(samples, evaluation);
  add_shares(evaluation);
  evaluation.interval = wilson_interval(evaluation.accuracy, evaluation.independent);
  return evaluation;
}

}  // namespace dts::lab::steadiness
