// SPDX-License-Identifier: Apache-2.0
#include "record/segment_table.h"

#include <algorithm>
#include <cmath>

namespace dts::record {
namespace {

constexpr std::size_t kMaxStarts = 1'000'000;
constexpr double kMaxScan = 9e15;  ///< Below 2^53, where a double holds every whole number exactly.

core::ScanIndex scan_after(double duration_s, core::Rate rate) noexcept {
  const double scans = std::round(duration_s * rate.hz());
  return {scans > 0.0 ? static_cast<std::uint64_t>(std::min(scans, kMaxScan)) : 0U};  // NaN gives 0 too
}

}  // namespace

void SegmentTable::add(const Start& start) {
  if (starts_.size() < kMaxStarts && std::isfinite(start.time_s) && std::isfinite(start.scan_0_time_s)) starts_.push_back(start);
}

void SegmentTable::sort() { std::ranges::stable_sort(starts_, {}, &Start::time_s); }

SegmentTable::Place SegmentTable::place_of(double time_s, core::Rate rate, core::Rate reference) const noexcept {
  if (starts_.empty() || std::isnan(time_s)) return {};
  const auto after = std::ranges::upper_bound(starts_, time_s + 0.5 / reference.hz(), {}, &Start::time_s);
  const Start& start = after == starts_.begin() ? starts_.front() : *std::prev(after);
  return {start.segment, scan_after(time_s - start.scan_0_time_s, rate)};
}

GridTracker::GridTracker(core::Rate rate) noexcept : scan_s_(1.0 / rate.hz()) {}

bool GridTracker::continues(double previous_s, double time_s) const noexcept {
  return std::abs(time_s - previous_s - scan_s_) <= 0.5 * scan_s_;
}

bool GridTracker::add(double time_s) noexcept {
  const bool is_next = previous_s_ && continues(*previous_s_, time_s);
  if (is_next) {
    ++scan_;
  } else {
    if (previous_s_) ++segment_;
    scan_ = 0;
  }
  previous_s_ = time_s;
  return !is_next;
}

}  // namespace dts::record
