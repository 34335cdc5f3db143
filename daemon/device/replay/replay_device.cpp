// SPDX-License-Identifier: Apache-2.0
#include "device/replay/replay_device.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "device/device_checks.h"

namespace dts::device::replay {
namespace {

using core::ErrorCode;

constexpr std::int64_t kSliceNs = 50 * core::kNanosecondsPerMillisecond;  // read() must see interrupt() within 100 ms
constexpr int kDiskPatienceMs = 10;
constexpr double kLongestGapMs = 5000.0;  // longest wait in a gap: the gap between two segments may be a whole night

}  // namespace

ReplayDevice::ReplayDevice(RecordedDevice recorded, std::unique_ptr<record::Recording> recording, PlayOptions options, core::Clock& clock)
    : recorded_(std::move(recorded)), recording_(std::move(recording)), options_(options), clock_(clock), queue_(*recording_, recorded_) {}

ReplayDevice::~ReplayDevice() { queue_.stop(); }

core::Result<core::Rate> ReplayDevice::exact_rate(core::Rate wanted) const {
  const auto checked = check_rate(recorded_.description, wanted);
  if (checked) return recorded_.rate;
  return core::fail(checked.error().code, checked.error().what,
                    "use the rate at which it was recorded: " + std::to_string(recorded_.rate.hz()) + " Hz");
}

DeviceReport ReplayDevice::report() const {
  DeviceReport report{.serial = recorded_.description.serial};
  if (recording_->session()) report.firmware = recording_->session()->firmware;
  const std::string& damage = recording_->damage();
  report.checks.push_back({.name = "the recording is whole",
                           .outcome = damage.empty() ? DeviceCheck::Outcome::Passed : DeviceCheck::Outcome::Warning,
                           .detail = damage});
  return report;
}

core::Status ReplayDevice::open() {
  const DeviceState now = state();
  if (now == DeviceState::Gone) {
    return core::fail(ErrorCode::WrongState, "cannot open " + recorded_.description.uri + ": it is gone", "close it first");
  }
  if (now != DeviceState::Closed) return {};
  if (has_ended_.load(std::memory_order_acquire)) {  // pairs with reach_end
    const std::string fault = fault_.data();
    return core::fail(ErrorCode::NotFound,
                      recorded_.description.uri + (fault.empty() ? " has been played to its end" : " stopped playing: " + fault),
                      "add loop=1 to repeat it forever");
  }
  move_to(DeviceState::Open);
  return {};
}

core::Result<core::Rate> ReplayDevice::start(const StartOptions& options) {
  const DeviceState now = state();
  const std::string& uri = recorded_.description.uri;
  if (now == DeviceState::Gone) return core::fail(ErrorCode::DeviceGone, "cannot start " + uri + ": it is gone");
  if (now != DeviceState::Open) {
    return core::fail(ErrorCode::WrongState,
                      "cannot start " + uri + (now == DeviceState::Closed ? ": it is not open" : ": it is streaming already"));
  }
  DTS_TRY(check_start(recorded_.description, options));
  DTS_TRY(queue_.start(options_.loops));
  max_block_scans_ = options.max_block_scans;
  position_ = 0;
  paced_ = 0;
  next_scan_ = 0;
  taken_ = 0;
  is_interrupted_.store(false, std::memory_order_relaxed);
  start_ns_ = clock_.now_ns();
  move_to(DeviceState::Streaming);
  return recorded_.rate;
}

ReadResult ReplayDevice::read(core::Block& block, std::int64_t deadline_ns) noexcept {
  block.set_count(0);
  const DeviceState now = state();
  if (now == DeviceState::Gone) return {ReadOutcome::Gone, {.reason = core::GapReason::Unplugged}};
  if (now != DeviceState::Streaming) return {};
  // A block of the wrong size is a mistake of the caller; it must not cause writes beyond a column.
  if (block.capacity() == 0 || block.channel_count() != recorded_.description.channels.size()) return {ReadOutcome::Timeout, {}};
  const PlayedItem* item = wait_for_item(deadline_ns);
  if (item == nullptr) return {ReadOutcome::Timeout, {}};
  switch (item->kind) {
    case PlayedItem::Kind::Scans: return read_scans(block, deadline_ns);
    case PlayedItem::Kind::Gap: return read_gap(item->gap, deadline_ns);
    case PlayedItem::Kind::End: break;
  }
  return reach_end(*item);
}

bool ReplayDevice::is_given_up(std::int64_t deadline_ns) noexcept {
  return clock_.now_ns() >= deadline_ns || is_interrupted_.exchange(false, std::memory_order_acquire);  // pairs with interrupt()
}

/// Waits for the play-ahead thread in real time, even if `clock_` is virtual, since the disk is real.
PlayedItem* ReplayDevice::wait_for_item(std::int64_t deadline_ns) noexcept {
  PlayedItem* item = queue_.front(kDiskPatienceMs);
  while (item == nullptr && !is_given_up(deadline_ns)) item = queue_.front(kDiskPatienceMs);
  return item;
}

std::int64_t ReplayDevice::instant_ns(std::uint64_t position) const noexcept {
  return start_ns_ + std::min(recorded_.rate.time_ns({position}), kFarthestNs);
}

std::int64_t ReplayDevice::due_ns(std::uint64_t position) const noexcept {
  const auto elapsed_ns = static_cast<double>(recorded_.rate.time_ns({position})) / options_.speed.value_or(1.0);
  return start_ns_ + std::llround(std::min(elapsed_ns, static_cast<double>(kFarthestNs)));
}

/// Waits until the next `scans` positions are due, at most until the deadline; returns how many are due.
std::uint64_t ReplayDevice::wait_until_due(std::uint64_t scans, std::int64_t deadline_ns) noexcept {
  if (!options_.speed || scans == 0) return scans;
  const std::int64_t last_ns = due_ns(paced_ + scans - 1);
  while (clock_.now_ns() < last_ns && !is_given_up(deadline_ns)) {
    clock_.sleep_until_ns(std::min({last_ns, deadline_ns, clock_.now_ns() + kSliceNs}));
  }
  const std::int64_t now_ns = clock_.now_ns();
  if (now_ns >= last_ns) return scans;
  std::uint64_t due = 0;
  for (std::uint64_t first_late = scans; due < first_late;) {  // binary search for the first position that is not due
    const std::uint64_t middle = due + (first_late - due) / 2;
    if (due_ns(paced_ + middle) <= now_ns) {
      due = middle + 1;
    } else {
      first_late = middle;
    }
  }
  return due;
}

ReadResult ReplayDevice::read_scans(core::Block& block, std::int64_t deadline_ns) noexcept {
  const std::size_t wanted = std::min(block.capacity(), max_block_scans_);
  block.set_count(wanted);
  block.first_scan = {next_scan_};
  block.host_time_ns = instant_ns(position_);
  block.host_time_uncertainty_ns = 0;
  block.clock_drift_ppm = 0.0;
  std::size_t filled = 0;
  while (filled < wanted) {
    PlayedItem* item = filled == 0 ? queue_.front(0) : wait_for_item(deadline_ns);
    if (item == nullptr || item->kind != PlayedItem::Kind::Scans) break;
    const std::size_t there = std::min(wanted - filled, item->block.count() - taken_);
    const auto due = static_cast<std::size_t>(wait_until_due(there, deadline_ns));
    copy(item->block, block, filled, due);
    filled += due;
    if (due < there) break;
  }
  block.set_count(filled);
  return {filled > 0 ? ReadOutcome::Scans : ReadOutcome::Timeout, {}};
}

void ReplayDevice::copy(const core::Block& from, core::Block& to, std::size_t at, std::size_t scans) noexcept {
  for (std::size_t channel = 0; channel < to.channel_count(); ++channel) {
    std::ranges::copy(from.column(channel).subspan(taken_, scans), to.column(channel).subspan(at).begin());
    std::ranges::copy(from.quality(channel).subspan(taken_, scans), to.quality(channel).subspan(at).begin());
  }
  taken_ += scans;
  position_ += scans;
  paced_ += scans;
  next_scan_ += scans;
  if (taken_ < from.count()) return;
  taken_ = 0;
  queue_.release();
}

ReadResult ReplayDevice::read_gap(const core::Gap& gap, std::int64_t deadline_ns) noexcept {
  const std::uint64_t waited = std::min(gap.missing_scans, recorded_.rate.scans_in_ms(kLongestGapMs));
  if (wait_until_due(waited, deadline_ns) < waited) return {ReadOutcome::Timeout, {}};
  const ReadResult result{ReadOutcome::Gap, gap};
  paced_ += waited;
  position_ += gap.missing_scans;
  next_scan_ = 0;
  queue_.release();
  return result;
}

ReadResult ReplayDevice::reach_end(const PlayedItem& item) noexcept {
  fault_ = item.fault;
  has_ended_.store(true, std::memory_order_release);  // pairs with open()
  move_to(DeviceState::Gone);
  return {ReadOutcome::Gone, {.reason = core::GapReason::Unplugged}};
}

core::Status ReplayDevice::set_sync_output(bool) { return refuse_sync_output(recorded_.description, state()); }

core::Status ReplayDevice::stop() {
  queue_.stop();
  if (state() == DeviceState::Streaming) move_to(DeviceState::Open);
  return {};
}

core::Status ReplayDevice::close() {
  queue_.stop();
  move_to(DeviceState::Closed);
  return {};
}

}  // namespace dts::device::replay
