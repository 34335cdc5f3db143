// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/rate.h"
#include "core/units.h"

namespace dts::record {

/// Which segment a time belongs to, and which scan of it.
///
///     segment   0                      gap   1
///     time    --|=======================|    |==================>
///            time of scan 0        start of 1: a sample less than half a scan before it belongs to it
class SegmentTable {
 public:
  struct Start {
    std::uint32_t segment = 0;
    double time_s = 0.0;         ///< From here on.
    double scan_0_time_s = 0.0;  ///< Earlier than `time_s` when a recording starts within a segment.
  };
  struct Place {
    std::uint32_t segment = 0;
    core::ScanIndex scan;
  };

  /// Takes no more than a million, nor such as have no finite time: files of other programs may say anything.
  void add(const Start& start);
  /// To be called once after all have been added: they need not come in order of time.
  void sort();
  [[nodiscard]] bool is_empty() const noexcept { return starts_.empty(); }
  /// In the segment's first scan at the earliest: nothing lies before the recording.
  [[nodiscard]] Place place_of(double time_s, core::Rate rate) const noexcept;

 private:
  std::vector<Start> starts_;
};

/// Finds the segments of a regular stream in its time stamps alone: one that is off the grid by more than half a scan starts another. The
/// grid goes on from the sample before, so that a clock that is a little off does not make segments.
class GridTracker {
 public:
  explicit GridTracker(core::Rate rate) noexcept;

  /// Whether a sample at `time_s` after one at `previous_s` continues it.
  [[nodiscard]] bool continues(double previous_s, double time_s) const noexcept;
  /// Takes one more sample; true when it starts a segment.
  bool take(double time_s) noexcept;
  [[nodiscard]] SegmentTable::Place place() const noexcept { return {segment_, {scan_}}; }  ///< Of the sample taken last.

 private:
  double scan_s_;
  std::optional<double> previous_s_;
  std::uint32_t segment_ = 0;
  std::uint64_t scan_ = 0;
};

}  // namespace dts::record
