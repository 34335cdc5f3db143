// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numeric>
#include <utility>

#include "physics/cop/cop_fit.h"
#include "physics/cop/cop_least_squares.h"

namespace dts::physics {
namespace {

/// Noise of a filtered deflection in the plate-model's sensor model: 3 mV rms and steps of 4.88 mV, window 3, at 0.35..0.9 V/mm.
constexpr double kDeflectionNoiseMm = 0.004;
/// The ridge keeps the coefficients bounded; this threshold only rejects sensors with identical values.
constexpr double kRankThreshold = 1e-9;

Point middle_of(const CopValidity& validity) {
  return {{0.5 * (validity.x_mm.lowest + validity.x_mm.highest)}, {0.5 * (validity.y_mm.lowest + validity.y_mm.highest)}};
}

struct Fitted {
  LeastSquaresSolution solution;
  std::vector<CopEstimate> left_out;
  double squares_mm2 = 0.0;  ///< Sum of the squared position errors of `left_out`.
};

void add_error(Fitted& fitted, const CopSample& sample, const CopEstimate& estimate) {
  fitted.left_out.push_back(estimate);
  fitted.squares_mm2 +=
      std::pow(estimate.x_mm - sample.load_position.x.value, 2) + std::pow(estimate.y_mm - sample.load_position.y.value, 2);
}

/// Fits a . w = P and b . w = P (cop - centre); divides every sample by its load, so that heavy loads do not dominate.
core::Result<Fitted> fit_ratio(std::span<const CopSample> samples, Point centre) {
  const std::size_t n = samples.front().deflection_mm.size();
  LeastSquares problem{.column_count = n, .target_count = 3, .system = {}, .targets = {}, .ridge = std::vector<double>(n, 0.0)};
  problem.rank_threshold = kRankThreshold;
  for (const CopSample& sample : samples) {
    for (const double w : sample.deflection_mm) problem.system.push_back(w / sample.load.value);
    problem.targets.insert(problem.targets.end(),
                           {1.0, (sample.load_position.x - centre.x).value, (sample.load_position.y - centre.y).value});
    for (double& ridge : problem.ridge) ridge += std::pow(kDeflectionNoiseMm / sample.load.value, 2);
  }
  DTS_TRY_ASSIGN(auto solution, solve(problem));
  Fitted fitted{.solution = std::move(solution), .left_out = {}};
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double* const out = fitted.solution.left_out.data() + 3 * k;
    add_error(fitted, samples[k],
              {.x_mm = centre.x.value + out[1] / out[0],
               .y_mm = centre.y.value + out[2] / out[0],
               .load_n = samples[k].load.value * out[0],
               .flags = 0});
  }
  return fitted;
}

/// Fits the quadratic terms of the shares w / S.
core::Result<Fitted> fit_quadratic(std::span<const CopSample> samples, Point centre, const Fitted& ratio) {
  const std::size_t n = samples.front().deflection_mm.size();
  const std::size_t terms = n * (n + 1) / 2;
  LeastSquares problem{.column_count = terms, .target_count = 2, .system = {}, .targets = {}, .ridge = std::vector<double>(terms, 0.0)};
  problem.rank_threshold = kRankThreshold;
  for (const CopSample& sample : samples) {
    const double sum = sum_of(sample);
    const double share_variance = std::pow(kDeflectionNoiseMm / sum, 2);
    std::size_t term = 0;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = i; j < n; ++j) {
        const double si = sample.deflection_mm[i] / sum;
        const double sj = sample.deflection_mm[j] / sum;
        problem.system.push_back(si * sj);
        problem.ridge[term++] += share_variance * (i == j ? 4.0 * si * si : si * si + sj * sj);
      }
    }
    problem.targets.insert(problem.targets.end(), {(sample.load_position.x - centre.x).value, (sample.load_position.y - centre.y).value});
  }
  DTS_TRY_ASSIGN(auto solution, solve(problem));
  Fitted fitted{.solution = std::move(solution), .left_out = {}};
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double* const out = fitted.solution.left_out.data() + 2 * k;
    add_error(fitted, samples[k],
              {.x_mm = centre.x.value + out[0], .y_mm = centre.y.value + out[1], .load_n = ratio.left_out[k].load_n, .flags = 0});
  }
  return fitted;
}

/// Returns the values of one target.
std::vector<double> column(const std::vector<double>& coefficients, std::size_t target, std::size_t target_count) {
  std::vector<double> values;
  for (std::size_t k = target; k < coefficients.size(); k += target_count) values.push_back(coefficients[k]);
  return values;
}

}  // namespace

core::Result<CopFit> fit_moment(std::span<const CopSample> samples, const CopValidity& validity) {
  const std::size_t n = samples.front().deflection_mm.size();
  if (samples.size() < 2 * n) {
    return refuse_calibration(std::to_string(samples.size()) + " samples are too few for moment with " + std::to_string(n) + " sensors",
                              "measure at least " + std::to_string(2 * n) + " contacts");
  }
  MomentForm form{.centre = middle_of(validity)};
  DTS_TRY_ASSIGN(auto ratio, fit_ratio(samples, form.centre));
  form.load_n_per_mm = column(ratio.solution.coefficients, 0, 3);
  form.x_moment_n = column(ratio.solution.coefficients, 1, 3);
  form.y_moment_n = column(ratio.solution.coefficients, 2, 3);
  for (std::size_t k = 0; k < n; ++k) {
    form.share.push_back(calibrated_range(samples, [k](const CopSample& sample) { return sample.deflection_mm[k] / sum_of(sample); }));
  }
  auto left_out = ratio.left_out;
  const std::size_t quadratic_terms = n * (n + 1) / 2;
  if (samples.size() >= 2 * quadratic_terms) {
    const auto quadratic = fit_quadratic(samples, form.centre, ratio);
    if (quadratic && quadratic->squares_mm2 < ratio.squares_mm2) {
      form.x_quadratic_mm = column(quadratic->solution.coefficients, 0, 2);
      form.y_quadratic_mm = column(quadratic->solution.coefficients, 1, 2);
      left_out = quadratic->left_out;
    }
  }
  return CopFit{.form = std::move(form), .validity = validity, .left_out = std::move(left_out)};
}

}  // namespace dts::physics
