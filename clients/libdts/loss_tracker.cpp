// SPDX-License-Identifier: Apache-2.0
#include "loss_tracker.h"

namespace dts::client {

Hole LossTracker::advance(const Position& next) noexcept {
  const Hole hole = has_last_ ? hole_before(next) : Hole{};
  has_last_ = true;
  last_ = next;
  return hole;
}

Hole LossTracker::hole_before(const Position& next) const noexcept {
  constexpr Hole kBackwards{.scans = 0, .is_exact = false, .is_consistent = false};
  if (next.sequence <= last_.sequence || next.segment < last_.segment) return kBackwards;
  if (next.segment > last_.segment) {
    const bool is_adjacent = next.sequence == last_.sequence + 1;
    return is_adjacent ? Hole{} : Hole{.scans = next.first_scan, .is_exact = false, .is_consistent = true};
  }
  const std::uint64_t expected = last_.first_scan + last_.scan_count;
  if (next.first_scan < expected) return kBackwards;
  return {.scans = next.first_scan - expected, .is_exact = true, .is_consistent = true};
}

}  // namespace dts::client
