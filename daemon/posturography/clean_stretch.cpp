// SPDX-License-Identifier: Apache-2.0
#include "posturography/clean_stretch.h"

#include <algorithm>
#include <cmath>

#include "posturography/trial_faults.h"

namespace dts::posturography {
namespace {

constexpr double kLongestShortGapS = 0.050;
constexpr double kFarthestMm = 1e9;  ///< Larger values are not a centre of pressure; squares of this value and their sums stay finite.

bool is_present(const CopSeries& series, std::size_t i) noexcept {
  const bool is_position = std::abs(series.ml_mm[i]) <= kFarthestMm && std::abs(series.ap_mm[i]) <= kFarthestMm;
  return is_position && (series.load_n.empty() || !(series.load_n[i] <= 0.0));
}

bool is_long_gap(const CopSeries& series, std::size_t samples) noexcept {
  return static_cast<double>(samples) / series.rate_hz > kLongestShortGapS + kTimeSlackS;
}

}  // namespace

Stretch CleanStretches::longest() const noexcept {
  const auto found = std::ranges::max_element(all, {}, &Stretch::size);
  return found == all.end() ? Stretch() : *found;
}

bool CleanStretches::is_cut(const CopSeries& series) const noexcept {
  return all.size() != 1 || is_long_gap(series, all.front().begin) || is_long_gap(series, series.ml_mm.size() - all.back().end);
}

CleanStretches clean_stretches(const CopSeries& series) {
  CleanStretches clean;
  for (std::size_t i = 0; i < series.ml_mm.size(); ++i) {
    if (!is_present(series, i)) {
      ++clean.missing;
      continue;
    }
    if (clean.all.empty() || is_long_gap(series, i - clean.all.back().end)) clean.all.push_back({.begin = i, .end = i});
    clean.all.back().end = i + 1;
  }
  return clean;
}

StretchCopy copy_of(const CopSeries& series, const Stretch& stretch) {
  StretchCopy copy{.ml_mm = std::vector<double>(stretch.size()),
                   .ap_mm = std::vector<double>(stretch.size()),
                   .first_ml_mm = series.ml_mm[stretch.begin],
                   .first_ap_mm = series.ap_mm[stretch.begin]};
  std::size_t before = 0;
  for (std::size_t i = 0; i < stretch.size(); ++i) {
    if (!is_present(series, stretch.begin + i)) {
      ++copy.interpolated;
      continue;
    }
    copy.ml_mm[i] = series.ml_mm[stretch.begin + i] - copy.first_ml_mm;
    copy.ap_mm[i] = series.ap_mm[stretch.begin + i] - copy.first_ap_mm;
    for (std::size_t gap = before + 1; gap < i; ++gap) {
      const double part = static_cast<double>(gap - before) / static_cast<double>(i - before);
      copy.ml_mm[gap] = copy.ml_mm[before] + part * (copy.ml_mm[i] - copy.ml_mm[before]);
      copy.ap_mm[gap] = copy.ap_mm[before] + part * (copy.ap_mm[i] - copy.ap_mm[before]);
    }
    before = i;
  }
  return copy;
}

}  // namespace dts::posturography
