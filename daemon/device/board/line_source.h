// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "core/clock.h"
#include "device/board/line_decoder.h"
#include "device/board/link_input.h"
#include "device/board/scan_source.h"

namespace dts::device::board {

using LineInput = LinkInput<LineDecoder>;

/// The form of a board's lines, and the range of its values.
struct LineShape {
  std::size_t channels = 1;
  FirstColumn first_column = FirstColumn::Value;
  unsigned counter_bits = 32;
  double lowest = 0.0;
  double highest = 0.0;
};

/// Scans of a board that writes lines of numbers.
///
/// - With a counter a loss is exact. A counter that is ahead of the time since the newest scan is a damaged digit, unless the next line
///   agrees with it. If it is more than 1 s ahead or runs backwards and the next line agrees, the board was reset: a new segment, its loss
///   from time. After half a turn of the counter the loss is estimated from time too.
/// - With a time in us a loss is estimated from the board's time alone: lines that are late by nearly a period, or more, follow a loss.
/// - Without both it is estimated from the time of arrival: at a bad line, or when lines arrive later and later.
class LineSource final : public ScanSource {
 public:
  LineSource(LineInput& input, Timeline& timeline, core::Clock& clock, const LineShape& shape, std::size_t max_block_scans);

  [[nodiscard]] bytes::ReadEnd pull(std::int64_t deadline_ns) noexcept override;
  [[nodiscard]] bool ask() noexcept override { return true; }  // a board with lines does not listen
  [[nodiscard]] bool start_again() noexcept override { return true; }
  [[nodiscard]] InputCounts counts() const noexcept override { return input_.decoder().counts(); }

 private:
  void handle(const Line& line, std::int64_t raw_ns) noexcept;
  [[nodiscard]] bool follows_by_counter(std::uint32_t counter, std::int64_t raw_ns) noexcept;
  [[nodiscard]] bool follows_by_time(std::uint32_t time_us, std::int64_t raw_ns) noexcept;
  [[nodiscard]] bool follows_by_arrival(std::int64_t raw_ns) noexcept;
  void lose(std::uint64_t scans, bool is_exact) noexcept;
  void restart_segment(std::int64_t raw_ns) noexcept;
  void add_scan(const Line& line, std::int64_t raw_ns) noexcept;

  LineInput& input_;
  core::Clock& clock_;
  LineShape shape_;
  bool has_line_ = false;                  ///< There was a good line since the start.
  bool is_new_segment_ = false;            ///< The pending line begins a segment: nothing before it counts.
  std::uint32_t last_position_ = 0;        ///< Counter or time of the newest line.
  std::uint64_t number_ = 0;               ///< Of the next scan for the timeline.
  std::uint64_t bad_lines_ = 0;            ///< Since the newest good line.
  std::optional<std::uint32_t> doubtful_;  ///< Counter of the line before, if it was not believed.
  double late_us_ = 0.0;                   ///< By the board's time: how late the newest line was; follows a wrong rate.
  std::optional<Line> pending_;            ///< A line behind a gap.
  std::int64_t pending_raw_ns_ = 0;
};

}  // namespace dts::device::board
