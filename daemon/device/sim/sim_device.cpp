// SPDX-License-Identifier: Apache-2.0
#include "device/sim/sim_device.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "device/device_checks.h"

namespace dts::device::sim {
namespace {

using core::ErrorCode;
using core::GapReason;

constexpr std::int64_t kSliceNs = 50 * core::kNanosecondsPerMillisecond;  // read() must see interrupt() within 100 ms
constexpr double kBufferMs = 4000.0;
constexpr double kCueWithinS = 0.15;  // shorter than any reaction time: a smaller delay of the reader has no effect

}  // namespace

SimDevice::SimDevice(SimParts parts, core::Clock& clock)
    : parts_(std::move(parts)), clock_(clock), row_(parts_.description.channels.size()) {}

SimDevice::~SimDevice() { SimDevice::close(); }

core::Status SimDevice::open() {
  const DeviceState now = state();
  if (now == DeviceState::Gone) {
    return core::fail(ErrorCode::WrongState, "cannot open " + parts_.description.uri + ": it is gone", "close it first");
  }
  if (now != DeviceState::Closed) return {};
  if (was_unplugged_ && clock_.now_ns() < plugged_in_at_ns_) {
    return core::fail(ErrorCode::NotFound, "cannot open " + parts_.description.uri + ": not plugged in",
                      "wait: the simulated device is plugged in again by itself");
  }
  DTS_TRY(parts_.scene->load());
  move_to(DeviceState::Open);
  return {};
}

core::Result<core::Rate> SimDevice::exact_rate(core::Rate wanted) const { return check_rate(parts_.description, wanted); }

core::Result<core::Rate> SimDevice::start(const StartOptions& options) {
  const DeviceState now = state();
  if (now == DeviceState::Gone) return core::fail(ErrorCode::DeviceGone, "cannot start " + parts_.description.uri + ": it is gone");
  if (now != DeviceState::Open) {
    const bool is_closed = now == DeviceState::Closed;
    return core::fail(ErrorCode::WrongState,
                      "cannot start " + parts_.description.uri + (is_closed ? ": it is not open" : ": it is streaming already"));
  }
  DTS_TRY(check_start(parts_.description, options));

  parts_.scene->restart();
  for (Cue old; cues_.pop(old);) {
  }
  window_ = parts_.fault.kind == FaultKind::Unplug && was_unplugged_ ? FaultWindow{} : fault_window(parts_.fault, options.rate);
  max_block_scans_ = options.max_block_scans;
  buffer_scans_ = std::max(options.rate.scans_in_ms(kBufferMs), static_cast<std::uint64_t>(max_block_scans_));
  next_ = 0;
  segment_start_ = 0;
  is_stuck_ = false;
  is_interrupted_.store(false, std::memory_order_relaxed);
  const std::int64_t start_ns = clock_.now_ns();
  pacer_ = Pacer(start_ns, options.rate, parts_.clock_error_ppm);
  parts_.scene->set_start(start_ns);
  move_to(DeviceState::Streaming);
  return options.rate;
}

bool SimDevice::is_break_ahead() const noexcept {
  return parts_.fault.kind != FaultKind::Stuck && (next_ < window_.end || parts_.fault.kind == FaultKind::Unplug);
}

ReadResult SimDevice::read(core::Block& block, std::int64_t deadline_ns) noexcept {
  block.set_count(0);
  const DeviceState now = state();
  if (now == DeviceState::Gone) return unplugged();
  if (now != DeviceState::Streaming) return {};
  // A block of the wrong size is a mistake of the caller; it must not cause writes beyond a column.
  if (block.capacity() == 0 || block.channel_count() != row_.size()) return {ReadOutcome::Timeout, {}};
  const std::uint64_t break_at = is_break_ahead() ? window_.first : FaultWindow::kNoScan;
  return next_ < break_at ? read_scans(block, break_at, deadline_ns) : read_break(deadline_ns);
}

bool SimDevice::has_more() noexcept {
  if (state() != DeviceState::Streaming) return false;
  const std::uint64_t break_at = is_break_ahead() ? window_.first : FaultWindow::kNoScan;
  return std::min(pacer_.taken_by(clock_.now_ns()), break_at) >= next_ + max_block_scans_;
}

std::uint64_t SimDevice::wait_for(std::uint64_t scans, std::int64_t deadline_ns) noexcept {
  while (true) {
    const std::int64_t now_ns = clock_.now_ns();
    const std::uint64_t taken = pacer_.taken_by(now_ns);
    if (taken >= scans || now_ns >= deadline_ns) return taken;
    if (is_interrupted_.exchange(false, std::memory_order_acquire)) return taken;  // pairs with interrupt()
    clock_.sleep_until_ns(std::min({pacer_.instant_ns(scans - 1), deadline_ns, now_ns + kSliceNs}));
  }
}

ReadResult SimDevice::read_scans(core::Block& block, std::uint64_t break_at, std::int64_t deadline_ns) noexcept {
  const std::uint64_t wanted = std::min(next_ + std::min(block.capacity(), max_block_scans_), break_at);
  const std::uint64_t taken = std::min(wait_for(wanted, deadline_ns), break_at);
  const std::uint64_t waiting = taken - next_;
  if (waiting == 0) return {ReadOutcome::Timeout, {}};
  if (waiting > buffer_scans_) return continue_at(taken, {GapReason::Overrun, waiting, true});
  fill(block, static_cast<std::size_t>(std::min(taken, wanted) - next_));
  return {ReadOutcome::Scans, {}};
}

ReadResult SimDevice::read_break(std::int64_t deadline_ns) noexcept {
  if (parts_.fault.kind == FaultKind::Unplug) {
    if (wait_for(window_.first + 1, deadline_ns) <= window_.first) return {ReadOutcome::Timeout, {}};
    was_unplugged_ = true;
    plugged_in_at_ns_ = clock_.now_ns() + std::llround(parts_.fault.for_s * core::kNanosecondsPerSecond);
    move_to(DeviceState::Gone);
    return unplugged();
  }
  if (wait_for(window_.end + 1, deadline_ns) <= window_.end) return {ReadOutcome::Timeout, {}};
  if (parts_.fault.kind == FaultKind::Overrun) return continue_at(window_.end, {GapReason::Overrun, window_.end - next_, true});
  // A silent device does not know how many scans it missed; the host estimates them from the duration and the nominal rate.
  const auto silent_ns = static_cast<double>(pacer_.instant_ns(window_.end) - pacer_.instant_ns(next_));
  const auto estimate = static_cast<std::uint64_t>(std::llround(silent_ns / core::kNanosecondsPerSecond * pacer_.rate().hz()));
  return continue_at(window_.end, {GapReason::Silence, estimate, false});
}

ReadResult SimDevice::continue_at(std::uint64_t scan, const core::Gap& gap) noexcept {
  next_ = scan;
  segment_start_ = scan;
  return {ReadOutcome::Gap, gap};
}

ReadResult SimDevice::unplugged() noexcept { return {ReadOutcome::Gone, {GapReason::Unplugged, 0, false}}; }

void SimDevice::fill(core::Block& block, std::size_t count) noexcept {
  block.set_count(count);
  block.first_scan = {next_ - segment_start_};
  block.host_time_ns = pacer_.instant_ns(next_);
  block.host_time_uncertainty_ns = 0;  // the simulator knows the exact time
  block.clock_drift_ppm = parts_.clock_error_ppm;
  for (std::size_t i = 0; i < count; ++i) {
    compute_scan(next_ + i);
    for (std::size_t channel = 0; channel < row_.size(); ++channel) {
      block.column(channel)[i] = row_[channel];
      block.quality(channel)[i] = std::isnan(row_[channel]) ? core::quality::kNoContact : std::uint8_t{0};
    }
  }
  next_ += count;
}

void SimDevice::compute_scan(std::uint64_t scan) noexcept {
  const core::Rate rate = pacer_.rate();
  const double time_s = static_cast<double>(scan) * static_cast<double>(rate.denominator()) / static_cast<double>(rate.numerator());
  pass_cues(scan, time_s);
  parts_.scene->evaluate(time_s, row_);
  parts_.daq.convert({row_.data(), parts_.converted_channels}, scan);
  if (parts_.fault.kind != FaultKind::Stuck || !window_.contains(scan)) return;
  double& value = row_[parts_.fault.channel];
  if (!std::exchange(is_stuck_, true)) stuck_value_ = value;
  value = stuck_value_;
}

void SimDevice::hear(const Cue& cue) noexcept {
  if (state() == DeviceState::Streaming) (void)cues_.push(cue);  // if full, the cue is dropped: no thread reads scans
}

void SimDevice::pass_cues(std::uint64_t scan, double time_s) noexcept {
  for (const Cue* cue = cues_.front(); cue != nullptr && cue->at_ns <= pacer_.instant_ns(scan); cue = cues_.front()) {
    // If the cue is too old, the person reacts late: scans that were already delivered do not change.
    parts_.scene->hear(std::max(pacer_.device_time_s(cue->at_ns), time_s - kCueWithinS), *cue);
    cues_.release();
  }
}

void SimDevice::interrupt() noexcept { is_interrupted_.store(true, std::memory_order_release); }  // pairs with wait_for

core::Status SimDevice::set_sync_output(bool) { return refuse_sync_output(parts_.description, state()); }

core::Status SimDevice::stop() {
  if (state() == DeviceState::Streaming) move_to(DeviceState::Open);
  return {};
}

core::Status SimDevice::close() {
  move_to(DeviceState::Closed);
  return {};
}

}  // namespace dts::device::sim
