// SPDX-License-Identifier: Apache-2.0
#include "loss_tracker.h"

namespace dts::client {

ScanGap LossTracker::advance(const Position& next) noexcept {
  const ScanGap gap = has_last_ ? gap_before(next) : ScanGap{};
  has_last_ = true;
  last_ = next;
  return gap;
}

ScanGap LossTracker::gap_before(const Position& next) const noexcept {
  constexpr ScanGap kBackwards{.scans = 0, .is_exact = false, .is_consistent = false};
  if (next.sequence <= last_.sequence || next.segment < last_.segment) return kBackwards;
  if (next.segment > last_.segment) {
    const bool is_adjacent = next.sequence == last_.sequence + 1;
    return is_adjacent ? ScanGap{} : ScanGap{.scans = next.first_scan, .is_exact = false, .is_consistent = true};
  }
  const std::uint64_t expected = last_.first_scan + last_.scan_count;
  if (next.first_scan < expected) return kBackwards;
  return {.scans = next.first_scan - expected, .is_exact = true, .is_consistent = true};
}

}  // namespace dts::client
