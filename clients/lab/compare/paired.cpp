// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/paired.h"

#include <cmath>
#include <numeric>

namespace dts::lab::compare {
namespace {

constexpr std::size_t kFewestPairs = 10;

void keep(Paired& paired, double t_a_s, double a_x, double a_y, double b_x, double b_y) {
  if (!std::isfinite(a_x + a_y + b_x + b_y)) return;
  paired.t_a_s.push_back(t_a_s);
  paired.a_x.push_back(a_x);
  paired.a_y.push_back(a_y);
  paired.b_x.push_back(b_x);
  paired.b_y.push_back(b_y);
}

/// Returns the sum of products about the means.
double covariance(const std::vector<double>& a, const std::vector<double>& b) {
  const auto count = static_cast<double>(a.size());
  const double mean_a = std::accumulate(a.begin(), a.end(), 0.0) / count;
  const double mean_b = std::accumulate(b.begin(), b.end(), 0.0) / count;
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - mean_a) * (b[k] - mean_b);
  return sum;
}

}  // namespace

Paired pair_up(const Recording& a, const Recording& b, const Alignment& alignment) {
  Paired paired;
  if (a.step_s() <= b.step_s()) {
    const SmoothSeries x(a.t_s, a.x_mm);
    const SmoothSeries y(a.t_s, a.y_mm);
    for (std::size_t row = 0; row < b.t_s.size(); ++row) {
      const double at_s = alignment.to_a_s(b.t_s[row]);
      keep(paired, at_s, x.at(at_s).value, y.at(at_s).value, b.x_mm[row], b.y_mm[row]);
    }
    return paired;
  }
  std::vector<double> b_on_a_s;
  for (const double t_s : b.t_s) b_on_a_s.push_back(alignment.to_a_s(t_s));
  const SmoothSeries x(b_on_a_s, b.x_mm);
  const SmoothSeries y(b_on_a_s, b.y_mm);
  for (std::size_t row = 0; row < a.t_s.size(); ++row) {
    keep(paired, a.t_s[row], a.x_mm[row], a.y_mm[row], x.at(a.t_s[row]).value, y.at(a.t_s[row]).value);
  }
  return paired;
}

double correlation(const Paired& paired) {
  if (paired.t_a_s.size() < kFewestPairs) return 0.0;
  const double aa = covariance(paired.a_x, paired.a_x) + covariance(paired.a_y, paired.a_y);
  const double bb = covariance(paired.b_x, paired.b_x) + covariance(paired.b_y, paired.b_y);
  const double ab = covariance(paired.a_x, paired.b_x) + covariance(paired.a_y, paired.b_y);
  return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0;
}

}  // namespace dts::lab::compare
