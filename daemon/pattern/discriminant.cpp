// SPDX-License-Identifier: Apache-2.0
#include "pattern/discriminant.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dts::pattern {
namespace {

/// Returns NaN if the value is missing or has no logarithm.
double standardised(const Predictor& predictor, std::optional<double> value) {
  if (!value || (predictor.is_logarithmic && *value <= 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return ((predictor.is_logarithmic ? std::log(*value) : *value) - predictor.mean) / predictor.sd;
}

}  // namespace

std::vector<double> probabilities_of(std::vector<double> scores) {
  const auto is_known = [](double score) { return score < std::numeric_limits<double>::infinity(); };
  if (scores.empty() || !std::ranges::all_of(scores, is_known)) return {};
  const double best = *std::ranges::max_element(scores);
  if (!std::isfinite(best)) return {};
  double sum = 0.0;
  for (double& score : scores) {
    score = std::exp(score - best);
    sum += score;
  }
  for (double& score : scores) score /= sum;
  return scores;
}

Answer classify(const Discriminant& discriminant, const posturography::Measures& measures) {
  Answer answer;
  std::vector<double> scores = discriminant.offsets;
  for (std::size_t p = 0; p < discriminant.predictors.size(); ++p) {
    const Predictor& predictor = discriminant.predictors[p];
    const auto value = measures.get(predictor.measure);
    if (value && (*value < predictor.least || *value > predictor.most)) answer.outside.push_back(predictor.measure);
    const double z = standardised(predictor, value);
    if (std::isnan(z)) answer.missing.push_back(predictor.measure);
    for (std::size_t k = 0; k < scores.size(); ++k) scores[k] += discriminant.weights[k][p] * z;
  }
  answer.probabilities = probabilities_of(std::move(scores));
  if (answer.probabilities.empty()) return answer;
  answer.best = static_cast<std::size_t>(std::ranges::max_element(answer.probabilities) - answer.probabilities.begin());
  return answer;
}

}  // namespace dts::pattern
