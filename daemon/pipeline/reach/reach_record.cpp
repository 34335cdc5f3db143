// SPDX-License-Identifier: Apache-2.0
#include "pipeline/reach/reach_record.h"

#include <algorithm>
#include <cmath>

#include "pipeline/reach/smoothness.h"

namespace dts::pipeline {
namespace {

constexpr double kHoldPart = 0.8;
constexpr double kShallowDipS = 0.6;
constexpr double kLeastDipMm = 0.03;
constexpr double kDipSpreads = 3.0;
constexpr double kOnsetPart = 0.05;
constexpr double kOnsetSpreads = 1.5;
constexpr double kOnsetSearchS = 1.0;

// Bending forward raises the transient because the weight moves forward. According to the plate model of section 4 (patch moved from 30 to
// 130 mm), the ratio then increases by 0.575 + 1.8 R times d2 / P1, where R is the ratio at rest; the trials of the development set agree.
// Less than half of this means no bending, or sensors swapped crosswise.
constexpr double kRatioGain = 0.575;
constexpr double kRatioGainPerRatio = 1.8;
constexpr double kRatioNoise = 0.01;

double least_ratio_change(const core::ReachFeatures& features) noexcept {
  const double gain = std::max(0.0, kRatioGain + kRatioGainPerRatio * features.rest_ratio);
  return 0.5 * gain * features.d2_mm() / features.p1_mm - kRatioNoise;
}

double mean_above(const TransientHistory& history, std::uint64_t first, double level_mm) noexcept {
  double sum_mm = 0.0;
  std::uint64_t count = 0;
  for (std::uint64_t tick = std::max(first, history.oldest()); tick <= history.now(); ++tick) {
    if (history.at(tick) < level_mm) continue;
    sum_mm += history.at(tick);
    ++count;
  }
  return count > 0 ? sum_mm / static_cast<double>(count) : level_mm;
}

}  // namespace

std::uint64_t find_onset(const TransientHistory& history, std::uint64_t from, std::uint64_t earliest, double rest_mm,
                         double limit_mm) noexcept {
  earliest = std::max(earliest, history.oldest());
  std::uint64_t tick = from;
  while (tick > earliest && std::abs(history.at(tick) - rest_mm) >= limit_mm) --tick;
  return tick;
}

void find_shallow_dip(ReachRecord& reach, const TransientHistory& history, double rate_hz) noexcept {
  if ((reach.flags & core::reach_flag::kNoInitiation) == 0) return;
  const auto back = static_cast<std::uint64_t>(kShallowDipS * rate_hz);
  TickPoint lowest{.tick = reach.p1_tick, .mm = reach.rest_mm};
  const std::uint64_t earliest = reach.p1_tick > back ? reach.p1_tick - back : 1;
  for (std::uint64_t tick = std::max(earliest, history.oldest()); tick <= reach.p1_tick; ++tick) {
    if (history.at(tick) < lowest.mm) lowest = {.tick = tick, .mm = history.at(tick)};
  }
  if (reach.rest_mm - lowest.mm < std::max(kLeastDipMm, kDipSpreads * reach.spread_mm)) return;
  reach.lowest = lowest;
  reach.flags &= static_cast<std::uint16_t>(~core::reach_flag::kNoInitiation);
}

void refine_onset(ReachRecord& reach, const TransientHistory& history, double rate_hz) noexcept {
  if ((reach.flags & core::reach_flag::kNoInitiation) != 0) return;
  const auto back = static_cast<std::uint64_t>(kOnsetSearchS * rate_hz);
  const std::uint64_t earliest = reach.lowest.tick > back ? reach.lowest.tick - back : 1;
  const double limit_mm = std::max(kOnsetPart * reach.dip_mm(), kOnsetSpreads * reach.spread_mm);
  reach.p1_tick = find_onset(history, reach.lowest.tick, earliest, reach.rest_mm, limit_mm);
}

core::ReachFeatures features_of(const ReachRecord& reach, const TransientHistory& history, double rate_hz) noexcept {
  core::ReachFeatures features;
  features.p1_mm = reach.rest_mm;
  features.p2_mm = reach.lowest.mm;
  features.p3_mm = reach.highest.mm;
  features.hold_mm = mean_above(history, reach.lowest.tick, reach.lowest.mm + kHoldPart * reach.swing_mm()) - reach.rest_mm;
  features.rise_s = static_cast<double>(reach.highest.tick - std::min(reach.lowest.tick, reach.highest.tick)) / rate_hz;
  features.rest_ratio = reach.rest_ratio;
  features.ratio_change = reach.ratio_at_highest - reach.rest_ratio;
  features.twist = reach.rest_twist;
  features.smoothness = spectral_arc_length(history, reach.p1_tick, reach.highest.tick, rate_hz);
  return features;
}

std::uint16_t doubts_of(const core::ReachFeatures& features, const SeatLimits& limits) noexcept {
  const bool is_minor = !(features.d2_mm() >= kMinorPart * features.p1_mm);
  const bool is_rest_odd = !(features.rest_ratio >= limits.least_rest_ratio && features.rest_ratio <= limits.most_rest_ratio);
  const bool is_change_odd = !is_minor && !(features.ratio_change >= least_ratio_change(features));
  const bool is_odd = is_rest_odd || is_change_odd || !(std::abs(features.twist) <= limits.most_twist);
  return static_cast<std::uint16_t>((is_minor ? core::reach_flag::kMinor : 0) | (is_odd ? core::reach_flag::kImplausible : 0));
}

}  // namespace dts::pipeline
