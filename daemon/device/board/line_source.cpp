// SPDX-License-Identifier: Apache-2.0
#include "device/board/line_source.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dts::device::board {
namespace {

using core::GapReason;

constexpr std::int64_t kDoubtNs = core::kNanosecondsPerSecond;  // a counter may be this far ahead of time, if two lines agree
constexpr double kMicrosecondNs = 1e3;
constexpr double kLatePart = 0.75;   // of a period: a line that is later follows a loss
constexpr double kFollowPart = 0.1;  // of a period: how far the expected time follows each line

}  // namespace

LineSource::LineSource(LineInput& input, Timeline& timeline, core::Clock& clock, const LineShape& shape, std::size_t max_block_scans)
    : ScanSource(timeline, shape.channels, max_block_scans + 1), input_(input), clock_(clock), shape_(shape) {
  note_scans(clock.now_ns());
}

bytes::ReadEnd LineSource::pull(std::int64_t deadline_ns) noexcept {
  if (pending_) {
    const Line line = *pending_;
    pending_.reset();
    handle(line, pending_raw_ns_);
    return bytes::ReadEnd::Bytes;
  }
  const LineInput::Next next = input_.next(deadline_ns);
  if (next.end != bytes::ReadEnd::Bytes) return next.end;
  if (next.piece.is_good) {
    handle(input_.decoder().line(), next.raw_ns);
  } else if (has_line_) {
    ++bad_lines_;
  }
  return next.end;
}

void LineSource::handle(const Line& line, std::int64_t raw_ns) noexcept {
  bool follows = true;
  if (!has_line_ || is_new_segment_) {
    has_line_ = true;
    is_new_segment_ = false;
  } else {
    switch (shape_.first_column) {
      case FirstColumn::Counter: follows = follows_by_counter(line.position, raw_ns); break;
      case FirstColumn::TimeUs: follows = follows_by_time(line.position, raw_ns); break;
      case FirstColumn::Value: follows = follows_by_arrival(raw_ns); break;
    }
  }
  if (follows) return add_scan(line, raw_ns);
  if (trouble().outcome != ReadOutcome::Gap) return;
  pending_ = line;
  pending_raw_ns_ = raw_ns;
}

/// Reports a loss; the line behind it begins a segment.
void LineSource::lose(std::uint64_t scans, bool is_exact) noexcept {
  report_loss(GapReason::Integrity, scans, is_exact);
  number_ += scans;
  bad_lines_ = 0;
  doubtful_.reset();
  is_new_segment_ = true;
}

/// Reports a loss that only the time of arrival shows.
void LineSource::restart_segment(std::int64_t raw_ns) noexcept {
  const std::uint64_t missing = std::max(bad_lines_, timeline().estimate_missing(1, raw_ns));
  timeline().restart();
  late_us_ = 0.0;
  lose(missing, false);
  number_ = 0;
}

bool LineSource::follows_by_counter(std::uint32_t counter, std::int64_t raw_ns) noexcept {
  const std::uint32_t mask = shape_.counter_bits == 16 ? 0xFFFFU : 0xFFFFFFFFU;
  const std::uint32_t lost = (counter - last_position_ - 1U) & mask;
  const bool is_confirmed = doubtful_ && ((*doubtful_ + 1U) & mask) == counter;
  if (lost == 0) {
    bad_lines_ = 0;
    doubtful_.reset();
    return true;
  }
  const std::uint64_t by_time = timeline().estimate_missing(1, raw_ns);
  const std::uint64_t most = is_confirmed ? timeline().estimate_missing(1, raw_ns + kDoubtNs) : by_time;
  if (by_time > mask / 2) {
    restart_segment(raw_ns);  // the counter may have turned
  } else if (lost <= mask / 2 && lost <= most) {
    lose(lost, true);
  } else if (is_confirmed) {
    restart_segment(raw_ns);  // the board was reset
  } else {
    ++bad_lines_;
    doubtful_ = counter;
  }
  return false;
}

bool LineSource::follows_by_time(std::uint32_t time_us, std::int64_t raw_ns) noexcept {
  const std::uint32_t elapsed_us = time_us - last_position_;
  if (elapsed_us >= 1U << 31U) {
    restart_segment(raw_ns);
    return false;
  }
  const double period_us = static_cast<double>(timeline().period_ns()) / kMicrosecondNs;
  const double late_us = late_us_ + static_cast<double>(elapsed_us) - period_us;
  const double missing = std::max(0.0, std::floor(late_us / period_us + 1.0 - kLatePart));
  late_us_ = late_us - missing * period_us;
  late_us_ -= std::clamp(late_us_, -kFollowPart * period_us, kFollowPart * period_us);
  bad_lines_ = 0;  // the time shows whether they were scans
  if (missing < 1.0) return true;
  lose(static_cast<std::uint64_t>(missing), false);
  return false;
}

bool LineSource::follows_by_arrival(std::int64_t raw_ns) noexcept {
  if (bad_lines_ == 0 && !timeline().host_time().has_loss()) return true;
  const std::int64_t late_ns = timeline().host_time().has_loss() ? timeline().host_time().missing_ns() : 0;
  bad_lines_ = std::max(bad_lines_, static_cast<std::uint64_t>(late_ns / std::max<std::int64_t>(1, timeline().period_ns())));
  restart_segment(raw_ns);
  return false;
}

void LineSource::add_scan(const Line& line, std::int64_t raw_ns) noexcept {
  last_position_ = line.position;
  note_scans(clock_.now_ns());
  if (!timeline().add(number_, line.position, 1, raw_ns)) {
    return break_off("the board's time_us does not fit its rate; correct rate_hz, or the board's program");
  }
  ++number_;
  const ScanQueue::Slot slot = queue().add(timeline().position(0));
  for (std::size_t i = 0; i < shape_.channels; ++i) {
    slot.values[i] = line.values[i];
    const bool is_inside = line.values[i] >= shape_.lowest && line.values[i] <= shape_.highest;
    slot.quality[i] = is_inside ? std::uint8_t{0} : core::quality::kRail;
  }
}

}  // namespace dts::device::board
