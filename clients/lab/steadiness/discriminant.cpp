// SPDX-License-Identifier: Apache-2.0
#include "lab/steadiness/discriminant.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace dts::lab::steadiness {
namespace {

using posturography::Measure;
using posturography::Measures;

/// Smallest variance of standardised measures, whose variance is 1. Without scatter within the classes, any direction would separate
/// perfectly.
constexpr double kLeastVariance = 1e-6;

std::vector<double> values_of(const Samples& samples, std::span<const std::size_t> rows, Measure measure) {
  std::vector<double> values;
  for (const std::size_t row : rows) values.push_back(samples.values[row].get(measure).value_or(0.0));
  return values;
}

/// Returns nothing if the measure does not vary, because it cannot separate classes.
std::optional<Predictor> predictor_of(Measure measure, std::vector<double> values) {
  const auto [least, most] = std::ranges::minmax(values);
  Predictor predictor{.measure = measure, .is_logarithmic = least > 0.0, .least = least, .most = most};
  if (predictor.is_logarithmic) std::ranges::transform(values, values.begin(), [](double value) { return std::log(value); });
  const auto count = static_cast<double>(values.size());
  for (const double value : values) predictor.mean += value / count;
  double squares = 0.0;
  for (const double value : values) squares += (value - predictor.mean) * (value - predictor.mean);
  predictor.sd = std::sqrt(squares / std::max(1.0, count - 1.0));
  const bool is_constant = !(predictor.sd > 1e-9 * std::max(1e-12, std::abs(predictor.mean)));
  return is_constant ? std::nullopt : std::optional(predictor);
}

/// Returns NaN if the value is missing or has no logarithm.
double standardised(const Predictor& predictor, const Measures& measures) {
  constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
  const auto value = measures.get(predictor.measure);
  if (!value || (predictor.is_logarithmic && *value <= 0.0)) return kUndefined;
  return ((predictor.is_logarithmic ? std::log(*value) : *value) - predictor.mean) / predictor.sd;
}

/// Rows as standardised predictors, with the mean of each class.
struct Cloud {
  Eigen::MatrixXd rows;   ///< [row][predictor]; later minus the mean of their class.
  Eigen::MatrixXd means;  ///< [class][predictor]
  Eigen::VectorXd counts;
};

Cloud cloud_of(const Samples& samples, std::span<const std::size_t> rows, const Discriminant& form) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  const auto width = static_cast<Eigen::Index>(form.predictors.size());
  const auto classes = static_cast<Eigen::Index>(form.classes.size());
  Cloud cloud{
      .rows = Eigen::MatrixXd(count, width), .means = Eigen::MatrixXd::Zero(classes, width), .counts = Eigen::VectorXd::Zero(classes)};
  std::vector<Eigen::Index> class_of;
  for (Eigen::Index k = 0; k < count; ++k) {
    const std::size_t row = rows[static_cast<std::size_t>(k)];
    for (Eigen::Index p = 0; p < width; ++p) {
      cloud.rows(k, p) = standardised(form.predictors[static_cast<std::size_t>(p)], samples.values[row]);
    }
    class_of.push_back(std::ranges::lower_bound(form.classes, samples.labels[row]) - form.classes.begin());
    cloud.means.row(class_of.back()) += cloud.rows.row(k);
    cloud.counts(class_of.back()) += 1.0;
  }
  cloud.means.array().colwise() /= cloud.counts.array();
  for (Eigen::Index k = 0; k < count; ++k) cloud.rows.row(k) -= cloud.means.row(class_of[static_cast<std::size_t>(k)]);
  return cloud;
}

struct Shrunk {
  Eigen::MatrixXd covariance;
  double intensity = 0.0;
};

/// Shrinks towards the mean variance times I: Ledoit & Wolf 2004, "A well-conditioned estimator for large-dimensional covariance matrices".
Shrunk shrunk_covariance(const Cloud& cloud) {
  const auto count = static_cast<double>(cloud.rows.rows());
  const auto width = static_cast<double>(cloud.rows.cols());
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(cloud.rows.cols(), cloud.rows.cols());
  const Eigen::MatrixXd sample = cloud.rows.transpose() * cloud.rows / count;
  const double mean_variance = sample.trace() / width;
  const double distance = (sample - mean_variance * identity).squaredNorm();
  const double fourth = cloud.rows.rowwise().squaredNorm().array().square().sum();
  const double error = std::max(0.0, (fourth - count * sample.squaredNorm()) / (count * count));
  const double intensity = distance > 0.0 ? std::min(1.0, error / distance) : 1.0;
  const double unbiased = count / std::max(1.0, count - static_cast<double>(cloud.means.rows()));
  const Eigen::MatrixXd target = std::max(mean_variance, kLeastVariance) * identity;
  const Eigen::MatrixXd mixed = (1.0 - intensity) * sample + intensity * target;
  return {.covariance = unbiased * mixed + kLeastVariance * identity, .intensity = intensity};
}

core::Result<Discriminant> form_of(const Samples& samples, std::span<const std::size_t> rows) {
  Discriminant form;
  for (const std::size_t row : rows) form.classes.push_back(samples.labels[row]);
  std::ranges::sort(form.classes);
  const auto repeated = std::ranges::unique(form.classes);
  form.classes.erase(repeated.begin(), repeated.end());
  if (form.classes.size() < 2) {
    return core::fail(core::ErrorCode::InvalidArgument, "the column has fewer than two different labels",
                      "choose another column with --label");
  }
  if (rows.size() <= form.classes.size()) {
    return core::fail(core::ErrorCode::InvalidArgument,
                      "only " + std::to_string(rows.size()) + " rows for " + std::to_string(form.classes.size()) + " labels",
                      "use more trials, or another column");
  }
  for (const Measure measure : samples.measures) {
    if (auto predictor = predictor_of(measure, values_of(samples, rows, measure))) form.predictors.push_back(*predictor);
  }
  if (form.predictors.empty())
    return core::fail(core::ErrorCode::InvalidArgument, "no measure differs between the rows", "choose other measures with --measures");
  return form;
}

}  // namespace

core::Result<Discriminant> fit(const Samples& samples, std::span<const std::size_t> rows) {
  DTS_TRY_ASSIGN(auto form, form_of(samples, rows));
  const Cloud cloud = cloud_of(samples, rows, form);
  const Shrunk shrunk = shrunk_covariance(cloud);
  const Eigen::MatrixXd weights = shrunk.covariance.ldlt().solve(cloud.means.transpose()).transpose();
  for (Eigen::Index k = 0; k < weights.rows(); ++k) {
    const Eigen::VectorXd row = weights.row(k);
    form.weights.emplace_back(row.data(), row.data() + row.size());
    const double share = cloud.counts(k) / cloud.counts.sum();
    form.offsets.push_back(std::log(share) - 0.5 * weights.row(k).dot(cloud.means.row(k)));
  }
  form.shrinkage = shrunk.intensity;
  if (!weights.allFinite())
    return core::fail(core::ErrorCode::Failed, "the discriminant is not finite", "choose fewer measures with --measures");
  return form;
}

Answer classify(const Discriminant& discriminant, const Measures& measures) {
  Answer answer;
  std::vector<double> scores = discriminant.offsets;
  for (std::size_t p = 0; p < discriminant.predictors.size(); ++p) {
    const Predictor& predictor = discriminant.predictors[p];
    const auto value = measures.get(predictor.measure);
    if (value && (*value < predictor.least || *value > predictor.most)) answer.outside.push_back(predictor.measure);
    const double z = standardised(predictor, measures);
    for (std::size_t k = 0; k < scores.size(); ++k) scores[k] += discriminant.weights[k][p] * z;
  }
  if (!std::ranges::all_of(scores, [](double score) { return std::isfinite(score); })) return answer;
  const auto best = std::ranges::max_element(scores);
  answer.best = static_cast<std::size_t>(best - scores.begin());
  double sum = 0.0;
  for (const double score : scores) sum += std::exp(score - *best);
  for (const double score : scores) answer.probabilities.push_back(std::exp(score - *best) / sum);
  return answer;
}

}  // namespace dts::lab::steadiness
