// SPDX-License-Identifier: Apache-2.0
#include "session/acquisition.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/utf8.h"

namespace dts::session {
namespace {

using core::kNanosecondsPerMillisecond;

constexpr std::int64_t kShortestRetryNs = 250 * kNanosecondsPerMillisecond;
constexpr std::int64_t kLongestRetryNs = 4000 * kNanosecondsPerMillisecond;
constexpr std::int64_t kStopLatencyNs = 50 * kNanosecondsPerMillisecond;
constexpr std::int64_t kRoomPauseNs = core::kNanosecondsPerMillisecond;
constexpr std::int64_t kReadPatienceNs = 100 * kNanosecondsPerMillisecond;
constexpr double kProvenMs = 1000.0;  // a stream that lasted this long is restarted immediately
constexpr std::int64_t kSilenceNs = 1000 * kNanosecondsPerMillisecond;
constexpr double kCountDoubtS = 1.0;        // a counted gap may be this much shorter than the time between its ends,
constexpr double kLargestRateError = 0.01;  // and so much of that time, because a device may be slow

std::string_view restart_message(core::GapReason reason) noexcept {
  switch (reason) {
    case core::GapReason::Overrun: return "the device's buffer was full; dtsd restarts the scan";
    case core::GapReason::Silence: return "the device stopped sending; dtsd restarts the scan";
    case core::GapReason::Stall: return "the device halted its data endpoint; dtsd restarts the scan";
    case core::GapReason::Integrity: return "the device's data failed a check (see dtsctl device test); dtsd restarts the scan";
    default: return "the device's stream ended unexpectedly; dtsd restarts the scan";
  }
}

void set_text(std::array<char, 512>& target, std::string_view text) noexcept {
  target.fill('\0');
  std::size_t size = std::min(text.size(), target.size() - 1);
  while (size > 0 && size < text.size() && !core::starts_character(text[size])) --size;
  std::copy_n(text.begin(), size, target.begin());
}

}  // namespace

void AcquisitionReport::set_message(std::string_view text) noexcept { set_text(message, text); }

Acquisition::Acquisition(device::Device& device, core::Clock& clock, ScanSink& sink, core::Rate rate, std::size_t block_scans)
    : device_(device), clock_(clock), sink_(sink), wanted_rate_(rate), block_scans_(block_scans) {
  acquired_.block = core::Block(device.describe().channels.size(), block_scans);
  report_.rate = rate;
  latest_.store(report_);
}

void Acquisition::request_stop() noexcept {
  stop_requested_.store(true, std::memory_order_release);  // pairs with the loads in run() and stream()
  device_.interrupt();
}

void Acquisition::run() noexcept {
  bool may_retry_at_once = true;  // once after the first start, after a stream that lasted and after a return
  while (!stop_requested_.load(std::memory_order_acquire)) {
    scans_since_start_ = 0;
    const bool was_away = was_lost_;
    if (bring_up()) stream();
    const bool has_lasted = scans_since_start_ >= wanted_rate_.scans_in_ms(kProvenMs);
    const bool has_returned = was_away && !was_lost_ && scans_since_start_ > 0;
    if (has_lasted || has_returned) {
      retry_pause_ns_ = 0;
      may_retry_at_once = true;
    }
    if (scans_since_start_ > 0 && std::exchange(may_retry_at_once, false)) continue;
    wait_before_retry();  // absent, or connected without scans, or broken repeatedly
  }
  device_.close();
  report_.device = device::DeviceState::Closed;
  publish_report();
}

bool Acquisition::bring_up() {
  if (device_.state() == device::DeviceState::Gone) device_.close();
  auto started = device_.open().and_then([&] { return device_.start({.rate = wanted_rate_, .max_block_scans = block_scans_}); });
  if (started && !(*started == wanted_rate_)) {  // but every format downstream has the wanted rate
    started = core::fail(core::ErrorCode::Internal, device_.describe().uri + " runs at " + std::to_string(started->hz()) +
                                                        " Hz, but promised " + std::to_string(wanted_rate_.hz()) + " Hz");
  }
  if (!started) {
    // A device that has streamed stays Gone until it streams again, however often opening it fails in between.
    report_.device = has_streamed_ ? device::DeviceState::Gone : device::DeviceState::Closed;
    report_.set_message(core::to_string(started.error()));
    publish_report();
    device_.close();
    was_lost_ = true;
    return false;
  }
  if (has_streamed_) {
    if (was_lost_) ++report_.reconnects_total;
    if (pending_gap_.reason == core::GapReason::None) note_gap({.reason = core::GapReason::Unplugged});
  }
  was_lost_ = false;
  needs_segment_ = true;
  report_.rate = *started;
  report_.device = device::DeviceState::Streaming;
  report_.is_silent = false;
  report_.is_armed = false;
  report_.set_message("");
  quiet_since_ns_ = clock_.now_ns();
  publish_report();
  return true;
}

void Acquisition::wait_before_retry() noexcept {
  retry_pause_ns_ = std::clamp(2 * retry_pause_ns_, kShortestRetryNs, kLongestRetryNs);
  const std::int64_t until_ns = clock_.now_ns() + retry_pause_ns_;
  while (clock_.now_ns() < until_ns && !stop_requested_.load(std::memory_order_acquire)) {
    clock_.sleep_until_ns(std::min(until_ns, clock_.now_ns() + kStopLatencyNs));
    note_turn();
    if (device_.has_arrived()) return;
  }
}

void Acquisition::stream() noexcept {
  const std::int64_t block_ns = report_.rate.time_ns({block_scans_});
  while (!stop_requested_.load(std::memory_order_acquire)) {
    if (device_.describe().waits_for_reader && !sink_.has_room()) {
      clock_.sleep_until_ns(clock_.now_ns() + kRoomPauseNs);
      note_turn();
      continue;
    }
    const std::int64_t deadline_ns = clock_.now_ns() + 2 * block_ns + kReadPatienceNs;
    const device::ReadResult result = device_.read(acquired_.block, deadline_ns);
    switch (result.outcome) {
      case device::ReadOutcome::Scans: pass_on(); break;
      case device::ReadOutcome::Timeout:
        note_turn();
        note_timeout(clock_.now_ns(), deadline_ns);
        break;
      case device::ReadOutcome::Armed:
        note_turn();
        note_armed(clock_.now_ns());
        break;
      case device::ReadOutcome::Gap: note_gap(result.gap); break;
      case device::ReadOutcome::Broken: restart(result.gap); return;
      case device::ReadOutcome::Gone:
        note_gap(result.gap.reason == core::GapReason::None ? core::Gap{.reason = core::GapReason::Unplugged} : result.gap);
        was_lost_ = true;
        report_.device = device::DeviceState::Gone;
        note_gone(device_.why_gone());
        return;
      case device::ReadOutcome::NotStreaming: return;
    }
  }
}

/// The supervisor may miss the message if the device is back within its turn: the gap keeps the reason.
void Acquisition::note_gone(const std::string& why) noexcept {
  if (why_pending_gap_.front() == '\0') set_text(why_pending_gap_, why);  // several losses before a scan are one gap with the first reason
  report_.set_message("device disconnected; plug it in again: dtsd opens it by itself");
  if (!why.empty()) report_.set_message(why + "; dtsd opens it again by itself");
  publish_report();
}

void Acquisition::restart(const core::Gap& gap) noexcept {
  note_gap(gap.reason == core::GapReason::None ? core::Gap{.reason = core::GapReason::Integrity} : gap);
  ++report_.restarts_total;
  report_.device = device::DeviceState::Open;
  report_.set_message(restart_message(gap.reason));
  publish_report();
  device_.stop();
}

void Acquisition::note_armed(std::int64_t now_ns) noexcept {
  quiet_since_ns_ = now_ns;
  if (report_.is_armed) return;
  report_.is_armed = true;
  report_.set_message("waiting for the external trigger");
  publish_report();
}

void Acquisition::note_gap(const core::Gap& gap) noexcept {
  if (pending_gap_.reason == core::GapReason::None) {
    pending_gap_ = gap;
  } else {  // second gap without a scan in between: merge both into one gap with the first reason
    pending_gap_.missing_scans += gap.missing_scans;
    pending_gap_.is_exact = pending_gap_.is_exact && gap.is_exact;
  }
  needs_segment_ = true;
}

/// The device is neither silent nor waiting for its trigger.
void Acquisition::note_delivery() noexcept {
  if (report_.is_silent || report_.is_armed) report_.set_message("");
  report_.is_silent = false;
  report_.is_armed = false;
  quiet_since_ns_ = clock_.now_ns();
}

void Acquisition::note_timeout(std::int64_t now_ns, std::int64_t deadline_ns) noexcept {
  if (now_ns - deadline_ns > kSilenceNs / 2) quiet_since_ns_ = now_ns;  // this process was suspended: no proof of a silent device
  const bool is_silent = now_ns - quiet_since_ns_ > kSilenceNs;
  if (!is_silent || report_.is_silent) return;
  report_.is_silent = true;
  report_.set_message("device is connected but delivers no scans; check its cable and power");
  publish_report();
}

void Acquisition::note_jumps(const core::Block& block) noexcept {
  const std::uint64_t expected = segment_base_ + report_.next_scan;
  const std::uint64_t index = block.first_scan.value;
  if (index != expected) {  // a miscounting driver must not shift the time axis unnoticed
    note_gap({.reason = core::GapReason::Integrity, .missing_scans = index > expected ? index - expected : 0});
  } else if (block.host_time_ns - report_.last_scan_host_ns > kSilenceNs + report_.rate.time_ns({1})) {
    note_gap({.reason = core::GapReason::Silence});
  }
}

/// The counted scans may be only part of the gap; the time between the scans before and after it covers the whole gap.
void Acquisition::compare_gap_with_time() noexcept {
  const std::int64_t asleep_ns = clock_.suspended_ns() - suspended_at_last_scan_ns_;
  const auto hole_ns = static_cast<double>(acquired_.block.host_time_ns - report_.last_scan_host_ns + asleep_ns);
  const double scans = std::max(0.0, std::round(hole_ns * 1e-9 * report_.rate.hz()) - 1.0);
  const auto counted = static_cast<double>(pending_gap_.missing_scans);
  // A count that is far too small has turned over: a device may count with 16 bits.
  if (scans * (1.0 - kLargestRateError) > counted + report_.rate.hz() * kCountDoubtS) pending_gap_.is_exact = false;
  if (!pending_gap_.is_exact) pending_gap_.missing_scans = std::max(pending_gap_.missing_scans, static_cast<std::uint64_t>(scans));
}

void Acquisition::open_segment() noexcept {
  if (pending_gap_.reason != core::GapReason::None) {
    if (has_streamed_) compare_gap_with_time();
    report_.losses.add(pending_gap_.reason, {.gaps = 1, .scans = pending_gap_.missing_scans});
    report_.last_gap = pending_gap_;
    report_.why_last_gap = std::exchange(why_pending_gap_, {});
    ++report_.segment;
  }
  acquired_.gap_before = pending_gap_;
  pending_gap_ = {};
  // A replay starts at the index of its recording. The unsigned difference may wrap; the subtraction in `take` wraps it back.
  segment_base_ = acquired_.block.first_scan.value - (has_streamed_ ? 0 : device_.describe().recorded_pipeline.first_scan);
  report_.next_scan = 0;
  needs_segment_ = false;
}

void Acquisition::pass_on() noexcept {
  core::Block& block = acquired_.block;
  if (!needs_segment_) note_jumps(block);
  acquired_.gap_before = {};
  if (needs_segment_) open_segment();
  block.segment = report_.segment;
  block.first_scan = {block.first_scan.value - segment_base_};
  acquired_.lost_scans_total = report_.losses.total().scans;
  report_.next_scan = block.first_scan.value + block.count();
  report_.scans_total += block.count();
  report_.last_scan_host_ns = block.host_time_ns + report_.rate.time_ns({block.count() - 1});
  suspended_at_last_scan_ns_ = clock_.suspended_ns();
  note_delivery();
  report_.host_time_uncertainty_ns = block.host_time_uncertainty_ns;
  report_.clock_drift_ppm = block.clock_drift_ppm;
  scans_since_start_ += block.count();
  has_streamed_ = true;
  publish_report();  // before the block: otherwise a marker sent in reply to a scan could be rejected because the report shows no scans yet
  sink_.process(acquired_, device_.has_more());
}

}  // namespace dts::session
