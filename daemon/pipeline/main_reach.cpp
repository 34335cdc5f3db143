// SPDX-License-Identifier: Apache-2.0
#include "pipeline/main_reach.h"

#include <algorithm>
#include <tuple>
#include <vector>

namespace dts::pipeline {
namespace {

/// Returns the key for the comparison of reaches: a full reach outranks a minor one or a dip only, then the larger swing counts.
std::tuple<bool, double> weight(const core::ReachEvent& event) {
  constexpr int kHardlyAny = core::reach_flag::kMinor | core::reach_flag::kDipOnly;
  const double swing_mm = event.features.p3_mm - event.features.p2_mm;
  return {(event.flags & kHardlyAny) == 0, swing_mm == swing_mm ? swing_mm : -1.0};
}

}  // namespace

std::optional<core::ReachEvent> main_reach(std::span<const core::ReachEvent> events) {
  std::vector<core::ReachEvent> finals;
  for (const core::ReachEvent& event : events) {
    const bool is_final = event.step == core::ReachStep::Final;
    if (!is_final && event.step != core::ReachStep::Cancelled) continue;
    std::erase_if(finals, [&](const core::ReachEvent& other) { return other.number == event.number && other.segment == event.segment; });
    if (is_final) finals.push_back(event);
  }
  const auto largest = std::ranges::max_element(finals, {}, weight);
  return largest == finals.end() ? std::nullopt : std::optional(*largest);
}

}  // namespace dts::pipeline
