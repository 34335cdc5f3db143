// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "lab/steadiness/discriminant_fit.h"

namespace dts::lab::steadiness {

/// Random numbers that are the same on every machine.
class LabRandom {
 public:
  explicit LabRandom(std::uint64_t seed) noexcept : state_(seed) {}
  /// Returns 0 .. count - 1; `count` must not be 0.
  [[nodiscard]] std::size_t index(std::size_t count) noexcept;
  /// Returns 0 .. count - 1 in random order.
  [[nodiscard]] std::vector<std::size_t> shuffled(std::size_t count);

 private:
  std::uint64_t state_;
};

/// Who is who among the rows. A row without a subject counts as a person of its own.
struct People {
  std::vector<std::size_t> of_row;  ///< Person of each row: 0 .. count - 1.
  std::size_t count = 0;
  std::size_t named = 0;            ///< People with a subject ID.
  bool is_label_of_person = false;  ///< No person has two labels.
};
[[nodiscard]] People people_of(const std::vector<std::string>& subjects, const std::vector<std::string>& labels);

/// A group of people that is left out together, for each row.
struct Folds {
  std::vector<std::size_t> of_row;
  std::size_t count = 0;
};
/// Each person alone; with more than 200 people, several together.
[[nodiscard]] Folds leave_one_out(const People& people);
/// Ten groups of people, by chance.
[[nodiscard]] Folds ten_folds(const People& people, LabRandom& random);

/// The probability of each class for each row, by a fit without the row's fold. A row without an answer has an empty list.
using Predictions = std::vector<std::vector<double>>;

/// Predicts each row with the fit of all other folds, by the columns `columns`. If a fit fails, its rows have no answer.
[[nodiscard]] Predictions predict_left_out(const Inputs& inputs, const std::vector<std::size_t>& columns, const Folds& folds);

/// Predictions by one column, which each fold chooses from its own training: the one with the largest AUC of single rows.
struct BestColumn {
  Predictions predictions;
  std::map<std::size_t, std::size_t> chosen;  ///< How many folds chose each column.
};
[[nodiscard]] BestColumn predict_by_best_column(const Inputs& inputs, const Folds& folds);

}  // namespace dts::lab::steadiness
