// SPDX-License-Identifier: Apache-2.0
#include "lab/compare.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace dts::lab {
namespace {

constexpr double kShortestOverlapS = 1.0;

/// Pairs of values of both recordings at the same instants.
struct Paired {
  std::vector<double> t_a_s;
  std::vector<double> a_x, a_y, b_x, b_y;
};

void keep(Paired& paired, double t_a_s, double a_x, double a_y, double b_x, double b_y) {
  if (!std::isfinite(a_x + a_y + b_x + b_y)) return;
  paired.t_a_s.push_back(t_a_s);
  paired.a_x.push_back(a_x);
  paired.a_y.push_back(a_y);
  paired.b_x.push_back(b_x);
  paired.b_y.push_back(b_y);
}

/// At the scans of the slower one.
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

AxisDifference difference(const std::vector<double>& a, const std::vector<double>& b) {
  const auto count = static_cast<double>(a.size());
  double mean_a = 0.0;
  double mean_b = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    mean_a += a[k] / count;
    mean_b += b[k] / count;
  }
  AxisDifference result{.mean_difference_mm = mean_b - mean_a};
  double aa = 0.0;
  double bb = 0.0;
  double ab = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double raw = b[k] - a[k];
    const double removed = raw - result.mean_difference_mm;
    result.rmse_mm += raw * raw / count;
    result.rmse_mean_removed_mm += removed * removed / count;
    result.largest_mm = std::max(result.largest_mm, std::abs(raw));
    result.largest_mean_removed_mm = std::max(result.largest_mean_removed_mm, std::abs(removed));
    aa += (a[k] - mean_a) * (a[k] - mean_a);
    bb += (b[k] - mean_b) * (b[k] - mean_b);
    ab += (a[k] - mean_a) * (b[k] - mean_b);
  }
  result.rmse_mm = std::sqrt(result.rmse_mm);
  result.rmse_mean_removed_mm = std::sqrt(result.rmse_mean_removed_mm);
  result.correlation = ab / std::sqrt(aa * bb);
  return result;
}

}  // namespace

core::Result<Comparison> compare(const Recording& a, const Recording& b) {
  auto alignment = align(a, b);
  if (!alignment) return tl::make_unexpected(alignment.error());
  const Paired paired = pair_up(a, b, *alignment);
  const double overlap_s = paired.t_a_s.empty() ? 0.0 : paired.t_a_s.back() - paired.t_a_s.front();
  if (overlap_s < kShortestOverlapS) {
    return core::fail(core::ErrorCode::Failed, "aligned, the recordings have less than a second in common",
                      "are they of the same trial? do trigger or marker mean the same in both?");
  }
  Comparison comparison{.alignment = *alignment,
                        .overlap_s = overlap_s,
                        .scan_count = paired.t_a_s.size(),
                        .x = difference(paired.a_x, paired.b_x),
                        .y = difference(paired.a_y, paired.b_y)};
  comparison.rmse_total_mm = std::hypot(comparison.x.rmse_mm, comparison.y.rmse_mm);
  comparison.rmse_total_mean_removed_mm = std::hypot(comparison.x.rmse_mean_removed_mm, comparison.y.rmse_mean_removed_mm);
  return comparison;
}

}  // namespace dts::lab
