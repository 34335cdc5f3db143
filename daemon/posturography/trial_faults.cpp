// SPDX-License-Identifier: Apache-2.0
#include "posturography/trial_faults.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace dts::posturography {
namespace {

constexpr double kHalf = 0.5;
constexpr double kLongestDipS = 0.050;

// A moved foot shifts the centre of pressure within a tenth of a second, and the shift stays. Sway that is as fast comes back, and sway
// that is as large is slower. Fast sway on foam: 133 mm/s (95 % of young people, AAMV), 13 mm in 100 ms.
constexpr double kJumpS = 0.100;
constexpr double kRestS = 0.200;
constexpr double kLeastJumpMm = 20.0;
constexpr double kLeastShiftMm = 25.0;

double median_load_n(const CopSeries& series, std::size_t first) {
  std::vector<double> loads;
  for (std::size_t i = first; i < series.load_n.size(); ++i) {
    if (series.load_n[i] > 0.0 && std::isfinite(series.load_n[i])) loads.push_back(series.load_n[i]);
  }
  if (loads.empty()) return 0.0;
  const auto middle = loads.begin() + static_cast<std::ptrdiff_t>(loads.size() / 2);
  std::nth_element(loads.begin(), middle, loads.end());
  return *middle;
}

/// sums[i]: sum of the first i values.
std::vector<double> running_sums(std::span<const double> values) {
  std::vector<double> sums(values.size() + 1, 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) sums[i + 1] = sums[i] + values[i];
  return sums;
}

}  // namespace

bool load_goes_away(const CopSeries& series, std::size_t first) {
  const double limit_n = kHalf * median_load_n(series, first);
  std::size_t low = 0;
  for (std::size_t i = first; i < series.load_n.size(); ++i) {
    low = series.load_n[i] < limit_n ? low + 1 : 0;
    if (static_cast<double>(low) / series.rate_hz > kLongestDipS + kTimeSlackS) return true;
  }
  return false;
}

bool position_jumps(std::span<const double> ml_mm, std::span<const double> ap_mm, std::size_t first, double rate_hz) {
  const auto jump = static_cast<std::size_t>(std::max(1.0, std::round(kJumpS * rate_hz)));
  const auto rest = static_cast<std::size_t>(std::max(1.0, std::round(kRestS * rate_hz)));
  if (first > ml_mm.size()) return false;
  const auto ml = ml_mm.subspan(first);
  const auto ap = ap_mm.subspan(first);
  const std::vector<double> ml_sums = running_sums(ml);
  const std::vector<double> ap_sums = running_sums(ap);
  const auto shift = [rest](const std::vector<double>& sums, std::size_t begin, std::size_t end) {
    return (sums[end + rest] - sums[end] - (sums[begin] - sums[begin - rest])) / static_cast<double>(rest);
  };
  for (std::size_t begin = rest; begin + jump + rest <= ml.size(); ++begin) {
    const std::size_t end = begin + jump;  // the second mean starts with this sample
    if (std::hypot(ml[end] - ml[begin], ap[end] - ap[begin]) <= kLeastJumpMm) continue;
    if (std::hypot(shift(ml_sums, begin, end), shift(ap_sums, begin, end)) > kLeastShiftMm) return true;
  }
  return false;
}

}  // namespace dts::posturography
