// SPDX-License-Identifier: Apache-2.0
#include "lab/steadiness/left_out_people.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "core/split_mix.h"
#include "lab/steadiness/scores.h"

namespace dts::lab::steadiness {
namespace {

constexpr std::size_t kMostFolds = 200;
constexpr std::size_t kTenFolds = 10;

Folds folds_by(const People& people, const std::vector<std::size_t>& fold_of_person, std::size_t count) {
  Folds folds{.of_row = {}, .count = count};
  for (const std::size_t person : people.of_row) folds.of_row.push_back(fold_of_person[person]);
  return folds;
}

/// Calls `work(training rows, left-out rows)` for each fold.
template <class Work>
void for_each_fold(const Folds& folds, const Work& work) {
  std::vector<std::vector<std::size_t>> left_out(folds.count);
  for (std::size_t row = 0; row < folds.of_row.size(); ++row) left_out[folds.of_row[row]].push_back(row);
  std::vector<std::size_t> training;
  for (std::size_t fold = 0; fold < folds.count; ++fold) {
    training.clear();
    for (std::size_t row = 0; row < folds.of_row.size(); ++row) {
      if (folds.of_row[row] != fold) training.push_back(row);
    }
    work(training, left_out[fold]);
  }
}

void predict(const Inputs& inputs, const std::vector<std::size_t>& columns, const std::vector<std::size_t>& training,
             const std::vector<std::size_t>& left_out, Predictions& predictions) {
  const auto fitted = fit(inputs, columns, training);
  if (!fitted) return;
  for (const std::size_t row : left_out) predictions[row] = probabilities(*fitted, inputs, row);
}

/// Returns how well one column alone separates the classes of `rows`: mean over the classes of |AUC - 0.5|.
double separation(const Inputs& inputs, std::size_t column, const std::vector<std::size_t>& rows) {
  std::vector<double> values;
  for (const std::size_t row : rows) values.push_back(inputs.columns[column][row]);
  double sum = 0.0;
  for (std::size_t one = 0; one < inputs.class_count; ++one) {
    std::vector<bool> is_class;
    for (const std::size_t row : rows) is_class.push_back(inputs.classes[row] == one);
    sum += std::abs(Ranking(values, is_class).auc().value_or(0.5) - 0.5);
    if (inputs.class_count == 2) break;  // the other class has the same
  }
  return sum;
}

}  // namespace

std::size_t LabRandom::index(std::size_t count) noexcept {
  state_ += core::kGoldenGamma;
  return static_cast<std::size_t>(core::split_mix(state_) % count);  // the bias is below 1e-14 for any table
}

std::vector<std::size_t> LabRandom::shuffled(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t k = count; k > 1; --k) std::swap(order[k - 1], order[index(k)]);
  return order;
}

People people_of(const std::vector<std::string>& subjects, const std::vector<std::string>& labels) {
  People people;
  std::map<std::string, std::size_t> person_of;
  std::map<std::size_t, std::set<std::string>> labels_of;
  for (std::size_t row = 0; row < subjects.size(); ++row) {
    std::size_t person = people.count;
    if (!subjects[row].empty()) person = person_of.try_emplace(subjects[row], people.count).first->second;
    people.count = std::max(people.count, person + 1);
    people.of_row.push_back(person);
    labels_of[person].insert(labels[row]);
  }
  people.named = person_of.size();
  people.is_label_of_person = std::ranges::all_of(labels_of, [](const auto& person) { return person.second.size() == 1; });
  return people;
}

Folds leave_one_out(const People& people) {
  const std::size_t count = std::min(people.count, kMostFolds);
  std::vector<std::size_t> fold_of_person;
  for (std::size_t person = 0; person < people.count; ++person) fold_of_person.push_back(person % count);
  return folds_by(people, fold_of_person, count);
}

Folds ten_folds(const People& people, LabRandom& random) {
  const std::size_t count = std::min(people.count, kTenFolds);
  std::vector<std::size_t> fold_of_person = random.shuffled(people.count);
  for (std::size_t& fold : fold_of_person) fold %= count;
  return folds_by(people, fold_of_person, count);
}

Predictions predict_left_out(const Inputs& inputs, const std::vector<std::size_t>& columns, const Folds& folds) {
  Predictions predictions(folds.of_row.size());
  for_each_fold(folds, [&](const auto& training, const auto& left_out) { predict(inputs, columns, training, left_out, predictions); });
  return predictions;
}

BestColumn predict_by_best_column(const Inputs& inputs, const Folds& folds) {
  BestColumn best{.predictions = Predictions(folds.of_row.size()), .chosen = {}};
  for_each_fold(folds, [&](const auto& training, const auto& left_out) {
    std::size_t chosen = 0;
    double most = -1.0;
    for (std::size_t column = 0; column < inputs.columns.size(); ++column) {
      const double here = separation(inputs, column, training);
      if (here > most) {
        most = here;
        chosen = column;
      }
    }
    ++best.chosen[chosen];
    predict(inputs, {chosen}, training, left_out, best.predictions);
  });
  return best;
}

}  // namespace dts::lab::steadiness
