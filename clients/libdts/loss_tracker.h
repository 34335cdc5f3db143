// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dts::client {

/// Where a block stands in its stream.
struct Position {
  std::uint32_t segment = 0;
  std::uint64_t first_scan = 0;
  std::uint64_t scan_count = 0;
  std::uint64_t sequence = 0;
};

/// What is missing between two blocks.
struct Hole {
  std::uint64_t scans = 0;
  bool is_exact = true;
  bool is_consistent = true;  ///< False: the position went backwards, which no loss explains.
};

/// Counts the scans missing before each block of one stream.
///
///     same segment          exact from the scan indices:   [0..9] [10..19]  (20..39 missing)  [40..49]   20
///     next segment, and the
///       sequence has no hole  none: the segment ended where the last block did
///       sequence has a hole   the end of the old segment is unknown: at least the new segment's missing head
class LossTracker {
 public:
  /// The hole before `next`; none before the first block.
  Hole advance(const Position& next) noexcept;
  void reset() noexcept { has_last_ = false; }

 private:
  [[nodiscard]] Hole hole_before(const Position& next) const noexcept;

  bool has_last_ = false;
  Position last_;
};

}  // namespace dts::client
