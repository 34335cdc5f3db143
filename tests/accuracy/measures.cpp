// SPDX-License-Identifier: Apache-2.0
#include "accuracy/measures.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "accuracy/low_pass.h"

namespace dts::accuracy {
namespace {

constexpr double kAnalysisHz = 100.0;
constexpr double kStillMm = 1e-4;  // a true COP travels as float: 1e-5 mm is its resolution at 100 mm

double mean(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Sum of the products of both axes' distances from their means.
double products(std::span<const double> a, std::span<const double> b) {
  const double mean_a = mean(a);
  const double mean_b = mean(b);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - mean_a) * (b[i] - mean_b);
  return sum;
}

double rms_about_mean(std::span<const double> values) { return std::sqrt(products(values, values) / static_cast<double>(values.size())); }

/// published - gain * true
std::vector<double> without(std::span<const double> published_mm, double gain, std::span<const double> true_mm) {
  std::vector<double> rest;
  for (std::size_t i = 0; i < true_mm.size(); ++i) rest.push_back(published_mm[i] - gain * true_mm[i]);
  return rest;
}

double path_length(const Locus& locus) {
  double length = 0.0;
  for (std::size_t i = 1; i < locus.ml_mm.size(); ++i) {
    length += std::hypot(locus.ml_mm[i] - locus.ml_mm[i - 1], locus.ap_mm[i] - locus.ap_mm[i - 1]);
  }
  return length;
}

/// pi sqrt(det S) (N^2 - 1)/N (0.05^(-2/(N-2)) - 1), S the sample covariance: the F quantile in closed form.
double prediction_ellipse(const Locus& locus) {
  const auto count = static_cast<double>(locus.ml_mm.size());
  const double both = products(locus.ml_mm, locus.ap_mm);
  const double determinant =
      (products(locus.ml_mm, locus.ml_mm) * products(locus.ap_mm, locus.ap_mm) - both * both) / (count - 1.0) / (count - 1.0);
  return std::numbers::pi * std::sqrt(std::fmax(0.0, determinant)) * (count * count - 1.0) / count *
         (std::pow(0.05, -2.0 / (count - 2.0)) - 1.0);
}

}  // namespace

Agreement compare(std::span<const double> published_mm, std::span<const double> true_mm) {
  const double true_rms_mm = rms_about_mean(true_mm);
  const bool stands_still = true_rms_mm < kStillMm;
  Agreement result;
  result.offset_mm = mean(published_mm) - mean(true_mm);
  result.centred_rmse_mm = rms_about_mean(without(published_mm, 1.0, true_mm));
  result.rmse_mm = std::hypot(result.centred_rmse_mm, result.offset_mm);
  result.gain = stands_still ? std::numeric_limits<double>::quiet_NaN() : products(published_mm, true_mm) / products(true_mm, true_mm);
  result.residual_mm = rms_about_mean(without(published_mm, stands_still ? 0.0 : result.gain, true_mm));
  return result;
}

SwayMeasures sway_measures(const Locus& locus) { return {path_length(locus), prediction_ellipse(locus)}; }

SwayMeasures sway_measures_lp10(const Locus& locus, double rate_hz) {
  const double ratio = rate_hz / kAnalysisHz;
  const bool is_multiple = ratio >= 1.0 && std::abs(ratio - std::round(ratio)) < 1e-9;
  const std::size_t step = is_multiple ? static_cast<std::size_t>(std::lround(ratio)) : 1;
  return sway_measures({every_nth(lp10(locus.ml_mm, rate_hz), step), every_nth(lp10(locus.ap_mm, rate_hz), step)});
}

}  // namespace dts::accuracy
