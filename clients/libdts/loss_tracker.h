// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dts::client {

/// Position of a block in its stream.
struct Position {
  std::uint32_t segment = 0;
  std::uint64_t first_scan = 0;
  std::uint64_t scan_count = 0;
  std::uint64_t sequence = 0;
};

/// Scans missing between two blocks.
struct ScanGap {
  std::uint64_t scans = 0;
  bool is_exact = true;
  bool is_consistent = true;  ///< False: the position went backwards, which no loss can explain.
};

/// Counts the scans missing before each block of one stream.
///
///     same segment                           exact, from the scan indices: [0..9] [10..19] (20..39 missing) [40..49]: 20
///     next segment, no gap in the sequence   no loss: the old segment ended with the last block
///     next segment, gap in the sequence      the end of the old segment is unknown: at least the missing start of the new segment
class LossTracker {
 public:
  /// Returns the gap before `next`; an empty one before the first block.
  ScanGap advance(const Position& next) noexcept;
  void reset() noexcept { has_last_ = false; }

 private:
  [[nodiscard]] ScanGap gap_before(const Position& next) const noexcept;

  bool has_last_ = false;
  Position last_;
};

}  // namespace dts::client
