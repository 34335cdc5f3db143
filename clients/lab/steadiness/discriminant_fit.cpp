// SPDX-License-Identifier: Apache-2.0
#include "lab/steadiness/discriminant_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace dts::lab::steadiness {
namespace {

/// Smallest variance of standardised columns, whose variance is 1. Without scatter within the classes, any direction would separate
/// perfectly.
constexpr double kLeastVariance = 1e-6;

/// Returns nothing if the column does not vary, because it cannot separate classes.
std::optional<FittedColumn> fitted_column(const Inputs& inputs, std::size_t column, std::span<const std::size_t> rows) {
  std::vector<double> values;
  for (const std::size_t row : rows) values.push_back(inputs.columns[column][row]);
  const auto [least, most] = std::ranges::minmax(values);
  FittedColumn fitted{.column = column, .is_logarithmic = least > 0.0, .least = least, .most = most};
  if (fitted.is_logarithmic) std::ranges::transform(values, values.begin(), [](double value) { return std::log(value); });
  const auto count = static_cast<double>(values.size());
  for (const double value : values) fitted.mean += value / count;
  double squares = 0.0;
  for (const double value : values) squares += (value - fitted.mean) * (value - fitted.mean);
  fitted.sd = std::sqrt(squares / std::max(1.0, count - 1.0));
  const bool is_constant = !(fitted.sd > 1e-9 * std::max(1e-12, std::abs(fitted.mean)));
  return is_constant ? std::nullopt : std::optional(fitted);
}

/// Returns NaN if the value has no logarithm.
double standardised(const FittedColumn& fitted, double value) {
  if (fitted.is_logarithmic && value <= 0.0) return std::numeric_limits<double>::quiet_NaN();
  return ((fitted.is_logarithmic ? std::log(value) : value) - fitted.mean) / fitted.sd;
}

/// Rows as standardised columns, with the mean of each class.
struct Cloud {
  Eigen::MatrixXd rows;   ///< [row][column]; later minus the mean of their class.
  Eigen::MatrixXd means;  ///< [class][column]; 0 for a class without a row.
  Eigen::VectorXd counts;
};

Cloud cloud_of(const Inputs& inputs, std::span<const std::size_t> rows, const std::vector<FittedColumn>& columns) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  const auto width = static_cast<Eigen::Index>(columns.size());
  const auto classes = static_cast<Eigen::Index>(inputs.class_count);
  Cloud cloud{
      .rows = Eigen::MatrixXd(count, width), .means = Eigen::MatrixXd::Zero(classes, width), .counts = Eigen::VectorXd::Zero(classes)};
  const auto class_of = [&](Eigen::Index k) { return static_cast<Eigen::Index>(inputs.classes[rows[static_cast<std::size_t>(k)]]); };
  for (Eigen::Index p = 0; p < width; ++p) {
    const FittedColumn& fitted = columns[static_cast<std::size_t>(p)];
    const auto& values = inputs.columns[fitted.column];
    for (Eigen::Index k = 0; k < count; ++k) cloud.rows(k, p) = standardised(fitted, values[rows[static_cast<std::size_t>(k)]]);
  }
  for (Eigen::Index k = 0; k < count; ++k) {
    cloud.means.row(class_of(k)) += cloud.rows.row(k);
    cloud.counts(class_of(k)) += 1.0;
  }
  cloud.means.array().colwise() /= cloud.counts.array().max(1.0);
  for (Eigen::Index k = 0; k < count; ++k) cloud.rows.row(k) -= cloud.means.row(class_of(k));
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
  const auto classes = static_cast<double>((cloud.counts.array() > 0.0).count());
  const double unbiased = count / std::max(1.0, count - classes);
  const Eigen::MatrixXd target = std::max(mean_variance, kLeastVariance) * identity;
  const Eigen::MatrixXd mixed = (1.0 - intensity) * sample + intensity * target;
  return {.covariance = unbiased * mixed + kLeastVariance * identity, .intensity = intensity};
}

core::Status check_rows(const Inputs& inputs, std::span<const std::size_t> rows) {
  std::vector<bool> is_present(inputs.class_count, false);
  for (const std::size_t row : rows) is_present[inputs.classes[row]] = true;
  const auto classes = static_cast<std::size_t>(std::ranges::count(is_present, true));
  if (classes < 2) {
    return core::fail(core::ErrorCode::InvalidArgument, "the column has fewer than two different labels",
                      "choose another column with --label");
  }
  if (rows.size() > classes) return {};
  return core::fail(core::ErrorCode::InvalidArgument,
                    "only " + std::to_string(rows.size()) + " rows for " + std::to_string(classes) + " labels",
                    "use more trials, or another column");
}

}  // namespace

core::Result<Fit> fit(const Inputs& inputs, std::span<const std::size_t> columns, std::span<const std::size_t> rows) {
  DTS_TRY(check_rows(inputs, rows));
  Fit fit;
  for (const std::size_t column : columns) {
    if (auto fitted = fitted_column(inputs, column, rows)) fit.columns.push_back(*fitted);
  }
  if (fit.columns.empty())
    return core::fail(core::ErrorCode::InvalidArgument, "no measure differs between the rows", "choose other measures with --measures");
  const Cloud cloud = cloud_of(inputs, rows, fit.columns);
  const Shrunk shrunk = shrunk_covariance(cloud);
  const Eigen::MatrixXd weights = shrunk.covariance.ldlt().solve(cloud.means.transpose()).transpose();
  for (Eigen::Index k = 0; k < weights.rows(); ++k) {
    const Eigen::VectorXd row = weights.row(k);
    fit.weights.emplace_back(row.data(), row.data() + row.size());
    const double share = cloud.counts(k) / cloud.counts.sum();
    fit.offsets.push_back(std::log(share) - 0.5 * weights.row(k).dot(cloud.means.row(k)));
  }
  fit.shrinkage = shrunk.intensity;
  if (!weights.allFinite())
    return core::fail(core::ErrorCode::Failed, "the discriminant is not finite", "choose fewer measures with --measures");
  return fit;
}

std::vector<double> probabilities(const Fit& fit, const Inputs& inputs, std::size_t row) {
  std::vector<double> scores = fit.offsets;
  for (std::size_t p = 0; p < fit.columns.size(); ++p) {
    const double z = standardised(fit.columns[p], inputs.columns[fit.columns[p].column][row]);
    for (std::size_t k = 0; k < scores.size(); ++k) scores[k] += fit.weights[k][p] * z;
  }
  return pattern::probabilities_of(std::move(scores));
}

std::vector<std::string> classes_of(const std::vector<std::string>& labels) {
  std::vector<std::string> classes = labels;
  std::ranges::sort(classes);
  const auto repeated = std::ranges::unique(classes);
  classes.erase(repeated.begin(), repeated.end());
  return classes;
}

std::vector<std::size_t> class_indices(const std::vector<std::string>& labels, const std::vector<std::string>& classes) {
  std::vector<std::size_t> indices;
  for (const std::string& label : labels)
    indices.push_back(static_cast<std::size_t>(std::ranges::lower_bound(classes, label) - classes.begin()));
  return indices;
}

Inputs inputs_of(const Samples& samples, const std::vector<std::string>& classes) {
  Inputs inputs{.columns = {}, .classes = class_indices(samples.labels, classes), .class_count = classes.size()};
  for (const posturography::Measure measure : samples.measures) {
    auto& column = inputs.columns.emplace_back();
    for (const posturography::Measures& values : samples.values) column.push_back(values.get(measure).value_or(0.0));
  }
  return inputs;
}

core::Result<pattern::Discriminant> fit_all(const Samples& samples) {
  pattern::Discriminant discriminant{.classes = classes_of(samples.labels), .predictors = {}, .weights = {}, .offsets = {}};
  const Inputs inputs = inputs_of(samples, discriminant.classes);
  std::vector<std::size_t> columns(inputs.columns.size());
  std::iota(columns.begin(), columns.end(), std::size_t{0});
  std::vector<std::size_t> rows(samples.labels.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  DTS_TRY_ASSIGN(auto fitted, fit(inputs, columns, rows));
  for (const FittedColumn& column : fitted.columns) {
    discriminant.predictors.push_back({.measure = samples.measures[column.column],
                                       .is_logarithmic = column.is_logarithmic,
                                       .mean = column.mean,
                                       .sd = column.sd,
                                       .least = column.least,
                                       .most = column.most});
  }
  discriminant.weights = std::move(fitted.weights);
  discriminant.offsets = std::move(fitted.offsets);
  discriminant.shrinkage = fitted.shrinkage;
  return discriminant;
}

}  // namespace dts::lab::steadiness
