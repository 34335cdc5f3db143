// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/compare.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace dts::lab::compare {
namespace {

constexpr double kShortestOverlapS = 1.0;
constexpr double kAgreementSd = 1.96;  // 95 % of normally distributed differences

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
  const double half_mm = kAgreementSd * result.rmse_mean_removed_mm * std::sqrt(count / std::max(1.0, count - 1.0));
  result.lower_limit_mm = result.mean_difference_mm - half_mm;
  result.upper_limit_mm = result.mean_difference_mm + half_mm;
  result.correlation = ab / std::sqrt(aa * bb);
  return result;
}

/// Converts times relative to the first scans to times of the clocks.
Alignment on_clocks(Alignment alignment, const Recording& a, const Recording& b) {
  alignment.offset_s += a.began_s - b.began_s;
  alignment.reference_s += b.began_s;
  for (Alignment::Piece& piece : alignment.pieces) {
    piece.from_s += b.began_s;
    piece.reference_s += b.began_s;
  }
  for (PulseFault& fault : alignment.faults) fault.time_s += a.began_s;
  return alignment;
}

double end_sd_s(const Alignment& alignment, const Paired& paired) {
  const auto at_s = [&](double t_a_s, double shift_s) { return alignment.sd_at_s(t_a_s - alignment.offset_s - shift_s); };
  // The first and the last piece that are aligned: they contain the first and the last scan that are compared.
  const auto is_known = [](const Alignment::Piece& piece) { return std::isfinite(piece.shift_s); };
  const auto first = std::ranges::find_if(alignment.pieces, is_known);
  const auto last = std::find_if(alignment.pieces.rbegin(), alignment.pieces.rend(), is_known);
  const double sd_of_first_s = at_s(paired.t_a_s.front(), first == alignment.pieces.end() ? 0.0 : first->shift_s);
  const double sd_of_last_s = at_s(paired.t_a_s.back(), last == alignment.pieces.rend() ? 0.0 : last->shift_s);
  return std::fmax(sd_of_first_s, sd_of_last_s);
}

}  // namespace

core::Result<Comparison> compare(const Recording& a, const Recording& b) {
  DTS_TRY_ASSIGN(auto alignment, align(a, b));
  Paired paired = pair_up(a, b, alignment);
  const double overlap_s = paired.t_a_s.empty() ? 0.0 : paired.t_a_s.back() - paired.t_a_s.front();
  if (overlap_s < kShortestOverlapS) {
    return core::fail(core::ErrorCode::Failed, "after alignment, the recordings overlap by less than 1 s",
                      "check that both recordings are of the same trial and that trigger or marker mean the same in both");
  }
  Comparison comparison{.alignment = on_clocks(alignment, a, b),
                        .end_sd_s = end_sd_s(alignment, paired),
                        .delay_a_s = a.delay_s,
                        .delay_b_s = b.delay_s,
                        .is_simulated = a.is_simulated || b.is_simulated,
                        .paired = {},
                        .overlap_s = overlap_s,
                        .scan_count = paired.t_a_s.size(),
                        .correlation = correlation(paired),
                        .x = difference(paired.a_x, paired.b_x),
                        .y = difference(paired.a_y, paired.b_y)};
  comparison.rmse_total_mm = std::hypot(comparison.x.rmse_mm, comparison.y.rmse_mm);
  comparison.paired = std::move(paired);
  comparison.rmse_total_mean_removed_mm = std::hypot(comparison.x.rmse_mean_removed_mm, comparison.y.rmse_mean_removed_mm);
  return comparison;
}

}  // namespace dts::lab::compare
