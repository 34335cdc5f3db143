// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/reach.h"
#include "pipeline/reach/rest_detector.h"
#include "pipeline/reach/transient_history.h"

namespace dts::pipeline {

/// A reach is minor if its d2 is below this part of P1: the arm alone raises the transient by 2.5 to 8 % of P1 (reach-model section 5).
inline constexpr double kMinorPart = 0.05;

/// A point of the smoothed transient.
struct TickPoint {
  std::uint64_t tick = 0;
  double mm = 0.0;
};

/// What is known of one reach so far: the rest before it and its extremes.
struct ReachRecord {
  double rest_mm = 0.0;
  double spread_mm = 0.0;
  double threshold_mm = 0.0;
  double rest_ratio = 0.0;
  double rest_twist = 0.0;
  std::uint64_t p1_tick = 0;
  TickPoint lowest;
  TickPoint highest;
  double ratio_at_highest = 0.0;
  std::uint16_t flags = 0;
  std::uint16_t resumed = 0;

  static constexpr std::size_t kStateSize = 13;

  [[nodiscard]] double swing_mm() const noexcept { return highest.mm - lowest.mm; }
  [[nodiscard]] double dip_mm() const noexcept { return rest_mm - lowest.mm; }
  [[nodiscard]] double rise_mm() const noexcept { return highest.mm - rest_mm; }

  template <class Self, class Archive>
  static void exchange(Self& self, Archive& archive) noexcept {
    constexpr std::uint64_t kLatest = std::uint64_t{1} << 52U;
    for (auto* mm : {&self.rest_mm, &self.threshold_mm, &self.rest_ratio, &self.rest_twist, &self.lowest.mm, &self.highest.mm,
                     &self.ratio_at_highest}) {
      archive.number(*mm, -kMostStateMm, kMostStateMm);
    }
    archive.number(self.spread_mm, 0.0, kMostStateMm);
    archive.count(self.p1_tick, kLatest);
    archive.count(self.lowest.tick, kLatest);
    archive.count(self.highest.tick, kLatest);
    archive.count(self.flags, 0xFFFF);
    archive.count(self.resumed, 0xFFFF);
  }
};

/// Returns the tick at which the transient left its rest: the last one before `from` that is still within `limit_mm` of rest.
[[nodiscard]] std::uint64_t find_onset(const TransientHistory& history, std::uint64_t from, std::uint64_t earliest, double rest_mm,
                                       double limit_mm) noexcept;

/// Searches a finished reach again for its dip: one below the threshold, immediately before the rise.
void find_shallow_dip(ReachRecord& reach, const TransientHistory& history, double rate_hz) noexcept;

/// Corrects the onset of a finished reach: the tick at which the transient passes 5 % of the dip.
void refine_onset(ReachRecord& reach, const TransientHistory& history, double rate_hz) noexcept;

[[nodiscard]] core::ReachFeatures features_of(const ReachRecord& reach, const TransientHistory& history, double rate_hz) noexcept;

/// Plausible sensor patterns of a seated person. The defaults are for the layout of reach-model section 4 (rows at 120 and 220 mm, 120 mm
/// apart) and its plate model: a weight centred 30 to 100 mm from the rear edge and up to 60 mm to a side gives ratios of -0.27 to -0.11
/// and twists of up to 0.12. If a rear and a front sensor of one side are swapped, the twist is above 0.22; if they are swapped crosswise,
/// the ratio is near 0.
struct SeatLimits {
  double least_rest_ratio = -0.4;
  double most_rest_ratio = -0.10;
  double most_twist = 0.17;
};

/// Returns the flags that follow from the features themselves: kMinor, kImplausible.
[[nodiscard]] std::uint16_t doubts_of(const core::ReachFeatures& features, const SeatLimits& limits) noexcept;

}  // namespace dts::pipeline
