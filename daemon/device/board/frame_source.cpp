// SPDX-License-Identifier: Apache-2.0
#include "device/board/frame_source.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dts::device::board {
namespace {

using core::GapReason;

constexpr char kAnother[] = "the board describes itself differently than before; the next start compares it with the address";
constexpr std::uint32_t kHalfTurn = 1U << 31U;  // a larger step of the counter is one backwards
constexpr std::int64_t kShortestStartPauseNs = core::kNanosecondsPerSecond;
constexpr std::int64_t kSilenceOfUnknownRateNs = 3 * core::kNanosecondsPerSecond;

}  // namespace

FrameSource::FrameSource(bytes::ByteLink& link, FrameInput& input, BoardFacts& facts, Timeline& timeline, core::Clock& clock,
                         const RunStart& start, std::size_t max_block_scans)
    : ScanSource(timeline, facts.channels().size(), max_block_scans + kMostScansInFrame),
      link_(link),
      input_(input),
      facts_(facts),
      clock_(clock),
      start_(start),
      started_again_ns_(clock.now_ns()) {
  note_scans(clock.now_ns());
}

bytes::ReadEnd FrameSource::pull(std::int64_t deadline_ns) noexcept {
  if (!pending_.empty()) {
    handle(std::exchange(pending_, {}), pending_raw_ns_);
    return bytes::ReadEnd::Bytes;
  }
  const FrameInput::Next next = input_.next(deadline_ns);
  if (next.end == bytes::ReadEnd::Bytes) handle(next.piece.payload, next.raw_ns);
  return next.end;
}

bool FrameSource::ask() noexcept {
  const core::Status sent = link_.write(describe_command().view());
  return sent || sent.error().code != core::ErrorCode::DeviceGone;
}

bool FrameSource::start_again() noexcept {
  started_again_ns_ = clock_.now_ns();
  if (!start_.is_commanded) return true;
  const core::Status sent = link_.write(start_command(start_.wanted).view());
  return sent || sent.error().code != core::ErrorCode::DeviceGone;
}

std::int64_t FrameSource::silence_ns() const noexcept {
  return start_.confirmed.is_known() ? ScanSource::silence_ns() : kSilenceOfUnknownRateNs;
}

std::optional<std::uint32_t> FrameSource::scans_until(std::uint8_t run, std::uint32_t counter) const noexcept {
  const bool is_ours = run_ ? *run_ == run : start_.is_commanded;
  const std::uint32_t behind = counter - next_counter_;
  if (!is_ours || behind >= kHalfTurn) return std::nullopt;
  return behind;
}

InputCounts FrameSource::counts() const noexcept {
  InputCounts counts = input_.decoder().counts();
  counts.rejected += rejected_;
  return counts;
}

void FrameSource::handle(std::span<const std::uint8_t> payload, std::int64_t raw_ns) noexcept {
  switch (static_cast<FrameType>(payload[0])) {
    case FrameType::Descriptor: return handle_descriptor(payload);
    case FrameType::Channel: return handle_channel(payload);
    case FrameType::Scans: return handle_scans(payload, raw_ns);
    case FrameType::Lost: return handle_lost(payload);
    case FrameType::Log: {
      const auto log = parse_log(payload);
      return log ? last_log_.store(*log) : refuse();
    }
    default: return refuse();
  }
}

/// The board is not what it was, even though dtsd cannot use what it says: the next start names the field.
void FrameSource::refuse_description(const Refusal& refusal) noexcept {
  refuse();
  if (refusal.is_malformed) return;
  facts_.doubt();
  break_off("the board's new description was rejected; the error of the next start names the field");
}

void FrameSource::handle_descriptor(std::span<const std::uint8_t> payload) noexcept {
  const auto descriptor = parse_descriptor(payload);
  if (!descriptor) return refuse_description(descriptor.error());
  if (facts_.add(*descriptor) == BoardFacts::Change::Another) return break_off(kAnother);
  if (descriptor->is_pattern) return break_off("the board sends its test pattern; the next start ends it");
  const bool has_stopped = start_.is_commanded && !descriptor->is_streaming;
  if (!has_stopped) {
    if (descriptor->rate != start_.confirmed) break_off("the board has changed its rate; correct its program");
    return;
  }
  // The board was reset and waits for START. The pause is for a board that answers many DESCRIBEs at once.
  if (clock_.now_ns() - started_again_ns_ < kShortestStartPauseNs) return;
  if (!start_again()) set_trouble(ReadOutcome::Gone, GapReason::Unplugged);
}

void FrameSource::handle_channel(std::span<const std::uint8_t> payload) noexcept {
  const auto channel = parse_channel(payload);
  if (!channel) return refuse_description(channel.error());
  const auto change = facts_.add(*channel);
  if (!change) return refuse_description(change.error());
  if (*change == BoardFacts::Change::Another) break_off(kAnother);
}

void FrameSource::handle_lost(std::span<const std::uint8_t> payload) noexcept {
  const auto lost = parse_lost(payload);
  if (!lost) return refuse();
  const auto behind = scans_until(lost->run, lost->counter);
  if (!behind) return;
  if (lost->reason != static_cast<std::uint8_t>(LostReason::Stopped)) {
    if (*behind > 0) lost_ = *lost;  // the SCANS with this counter shows how many
    return;
  }
  if (*behind == 0) return;
  run_ = lost->run;
  next_counter_ = lost->counter;
  number_ += *behind;
  counted_missing_ += *behind;
  report_loss(GapReason::Integrity, *behind, true);
}

/// Returns the reason of a gap of `lost` scans from `next_counter_` on: that of a LOST within it.
GapReason FrameSource::reason_of_gap(std::uint32_t lost) const noexcept {
  const bool is_within = lost_ && lost_->counter - next_counter_ - 1U < lost;
  const std::uint8_t reason = is_within ? lost_->reason : std::uint8_t{0};
  return reason == static_cast<std::uint8_t>(LostReason::BufferFull) || reason == static_cast<std::uint8_t>(LostReason::Late)
             ? GapReason::Overrun
             : GapReason::Integrity;
}

/// Returns true if the frame continues the segment. Otherwise sets the trouble, and the state as it is after the trouble.
bool FrameSource::follows(const Scans& scans, std::int64_t raw_ns) noexcept {
  if (!run_) {
    run_ = scans.run;
    if (!start_.is_commanded) next_counter_ = scans.counter;  // it ran before we listened
  } else if (scans.run != *run_) {
    // A new run counts from 0: the scans before this frame are missing at least.
    const std::uint64_t counted = start_.is_commanded && scans.counter < kHalfTurn ? scans.counter : 0;
    const std::uint64_t estimated = timeline().estimate_missing(scans.count, raw_ns);
    const std::uint64_t missing = std::max(counted, estimated - std::min(estimated, counted_missing_));
    run_ = scans.run;
    next_counter_ = scans.counter;
    number_ = 0;
    counted_missing_ = 0;
    lost_.reset();
    timeline().restart();
    report_loss(GapReason::Integrity, missing, false);
    return false;
  }
  const std::uint32_t lost = scans.counter - next_counter_;
  if (lost >= kHalfTurn) {
    break_off("the counter of the board runs backwards; correct its program");
    return false;
  }
  if (lost == 0) return true;
  const GapReason reason = reason_of_gap(lost);
  next_counter_ = scans.counter;
  number_ += lost;
  counted_missing_ += lost;
  report_loss(reason, lost, true);
  return false;
}

void FrameSource::handle_scans(std::span<const std::uint8_t> payload, std::int64_t raw_ns) noexcept {
  const auto scans = parse_scans(payload, facts_.channels().size());
  if (!scans) return refuse();
  note_scans(clock_.now_ns());
  if (follows(*scans, raw_ns)) return add_scans(*scans, raw_ns);
  if (trouble().outcome != ReadOutcome::Gap) return;
  pending_ = payload;
  pending_raw_ns_ = raw_ns;
}

void FrameSource::add_scans(const Scans& scans, std::int64_t raw_ns) noexcept {
  if (!timeline().add(number_, scans.ticks, scans.count, raw_ns)) {
    return break_off("the ticks of the board contradict its counter: it does not count every scan; correct its program");
  }
  const std::span<const Channel> channels = facts_.channels();
  for (std::size_t scan = 0; scan < scans.count; ++scan) {
    const ScanQueue::Slot slot = queue().add(timeline().position(scan));
    for (std::size_t i = 0; i < channels.size(); ++i) {
      const Channel& channel = channels[i];
      const std::int16_t code = scans.code(scan * channels.size() + i);
      const bool is_inside = code >= channel.lowest && code <= channel.highest;
      if (channel.is_constant && !is_inside) {  // the channels are rotated, or the converter has failed
        queue().take_back();
        return break_off("the constant channel has a wrong code: channels are rotated; check the wiring and the program of the board");
      }
      const double value = channel.value(code);
      const bool is_number = std::isfinite(value);
      slot.values[i] = is_number ? value : std::numeric_limits<double>::quiet_NaN();
      slot.quality[i] = !is_number ? core::quality::kOutOfRange : is_inside ? std::uint8_t{0} : core::quality::kRail;
    }
  }
  next_counter_ += static_cast<std::uint32_t>(scans.count);
  number_ += scans.count;
  counted_missing_ = 0;
  if (lost_ && lost_->counter - next_counter_ - 1U >= kHalfTurn) lost_.reset();  // its scans have come
}

}  // namespace dts::device::board
