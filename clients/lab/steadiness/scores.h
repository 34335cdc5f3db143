// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace dts::lab::steadiness {

/// Ranks cases by a score, so that the area under the ROC curve (AUC) can be computed for many weightings of them.
class Ranking {
 public:
  /// `scores` are finite; `is_positive` has one item per score.
  Ranking(std::span<const double> scores, const std::vector<bool>& is_positive);

  /// Returns the AUC: the probability that a positive case has a higher score than a negative one; equal scores count half. `weights`: how
  /// often each case counts. Returns nothing if there is no positive or no negative case.
  [[nodiscard]] std::optional<double> auc(std::span<const double> weights) const;
  [[nodiscard]] std::optional<double> auc() const;

  /// Returns the share of correct cases where the errors of both kinds are equally frequent: the largest of the smaller one of sensitivity
  /// and specificity, over all limits. Returns 0.5 if there is no positive or no negative case.
  [[nodiscard]] double equal_error_correct() const;

 private:
  /// A case in the order of the scores.
  struct Case {
    std::size_t index = 0;
    bool is_positive = false;
    bool is_tied = false;  ///< Has the score of the case before it.
  };
  std::vector<Case> cases_;
};

/// Returns the slope of the logistic regression of the outcome on the log odds of `probabilities` (calibration: 1 is right, below 1 too
/// confident). Returns nothing if it does not exist, for example if the classes are separated perfectly.
[[nodiscard]] std::optional<double> calibration_slope(std::span<const double> probabilities, const std::vector<bool>& is_positive);

}  // namespace dts::lab::steadiness
