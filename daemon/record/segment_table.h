// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/rate.h"
#include "core/units.h"

namespace dts::record {

/// Finds the segment and the scan that a time belongs to.
///
///     segment   0                      gap   1
///     time    --|=======================|    |==================>
///            time of scan 0        start of segment 1; a sample less than half a raw scan earlier is part of segment 1
class SegmentTable {
 public:
  struct Start {
    std::uint32_t segment = 0;
    double time_s = 0.0;         ///< The segment begins here.
    double scan_0_time_s = 0.0;  ///< Earlier than `time_s` if the recording starts within the segment.
  };
  struct Place {
    std::uint32_t segment = 0;
    core::ScanIndex scan;
  };

  /// Adds a start. Ignores starts beyond one million and starts whose times are not finite: files of other programs may hold anything.
  void add(const Start& start);
  /// Sorts the starts by time. Call it once, after the last `add`.
  void sort();
  [[nodiscard]] bool is_empty() const noexcept { return starts_.empty(); }
  /// Returns the segment and scan at `time_s` of a stream with `rate`. A time before the recording belongs to the first segment, a time
  /// before scan 0 to scan 0. Starts are times of scans at the rate `reference`: half a scan of a slower stream could be beyond a short
  /// gap.
  [[nodiscard]] Place place_of(double time_s, core::Rate rate, core::Rate reference) const noexcept;

 private:
  std::vector<Start> starts_;
};

/// Finds the segments of a regular stream from its time stamps alone: a time stamp off the grid by more than half a scan starts a segment.
/// The grid continues from the previous sample, so a clock that is slightly wrong starts no segments.
class GridTracker {
 public:
  explicit GridTracker(core::Rate rate) noexcept;

  /// Returns true if a sample at `time_s` is the next one after the sample at `previous_s`.
  [[nodiscard]] bool continues(double previous_s, double time_s) const noexcept;
  /// Adds one more sample; returns true if it starts a segment.
  bool add(double time_s) noexcept;
  [[nodiscard]] SegmentTable::Place place() const noexcept { return {segment_, {scan_}}; }  ///< Of the sample added last.

 private:
  double scan_s_;
  std::optional<double> previous_s_;
  std::uint32_t segment_ = 0;
  std::uint64_t scan_ = 0;
};

}  // namespace dts::record
