// SPDX-License-Identifier: Apache-2.0
#include "device/mcc/joined_pair.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "device/device_checks.h"

namespace dts::device::mcc {
namespace {

using core::ErrorCode;

constexpr std::int64_t kLagNs = 250 * core::kNanosecondsPerMillisecond;
constexpr std::size_t kPacketCodes = 32;  // at low rates a packet takes longer
constexpr std::uint64_t kMostPacketsApart = 2;

constexpr double kWindowMs = 2000.0;
constexpr int kFewestWaits = 8;
constexpr int kMostBlocksBehind = 1000;
constexpr double kMissedPulsesMs = 50.0;                             // longer than a packet, shorter than the silence limit
constexpr std::int64_t kFrameNs = core::kNanosecondsPerMillisecond;  // packets of the same instant may be sent in two frames
constexpr std::int64_t kTransferNs = 10 * core::kNanosecondsPerMillisecond;

tl::unexpected<core::Error> pass_on(const core::Error& error, const char* which) {
  core::Error named = error;
  named.what = std::string(which) + " unit of the pair: " + named.what;
  return tl::make_unexpected(named);
}

void copy_columns(const core::Block& from, core::Block& to, std::size_t first_channel, std::size_t scans) noexcept {
  for (std::size_t channel = 0; channel < from.channel_count(); ++channel) {
    std::copy_n(from.column(channel).begin(), scans, to.column(first_channel + channel).begin());
    std::copy_n(from.quality(channel).begin(), scans, to.quality(first_channel + channel).begin());
  }
}

}  // namespace

JoinedPair::JoinedPair(PairParts parts, core::Clock& clock)
    : master_{.device = std::move(parts.master), .fresh = {}, .waiting = {}},
      slave_{.device = std::move(parts.slave), .fresh = {}, .waiting = {}},
      confirm_master_stopped_(std::move(parts.confirm_master_stopped)),
      clock_(clock),
      description_(std::move(parts.description)) {}

JoinedPair::~JoinedPair() { JoinedPair::close(); }

core::Result<core::Rate> JoinedPair::exact_rate(core::Rate wanted) const {
  const auto checked = check_rate(description_, wanted);
  return checked ? master_.device->exact_rate(wanted) : checked;
}

DeviceReport JoinedPair::report() const {
  DeviceReport first = master_.device->report();
  DeviceReport second = slave_.device->report();
  if (first.serial.empty() && second.serial.empty()) return {};
  DeviceReport both{.serial = first.serial + "+" + second.serial,
                    .nodes = std::move(first.nodes),
                    .firmware = first.firmware + "+" + second.firmware,
                    .checks = {}};
  for (std::string& node : second.nodes) both.nodes.push_back(std::move(node));
  for (DeviceCheck& check : first.checks) both.checks.push_back({"first unit: " + check.name, check.outcome, check.detail});
  for (DeviceCheck& check : second.checks) both.checks.push_back({"second unit: " + check.name, check.outcome, check.detail});
  if (has_missed_pulses_.load(std::memory_order_acquire)) {  // pairs with cause_of
    both.checks.push_back({"the second unit receives SYNC", DeviceCheck::Outcome::Failed, "no pulses: check the SYNC wire"});
  }
  return both;
}

bool JoinedPair::has_arrived() noexcept {
  const bool has_first = master_.device->has_arrived();
  const bool has_second = slave_.device->has_arrived();
  return has_first || has_second;
}

core::Status JoinedPair::open() {
  if (state() == DeviceState::Gone) {
    return core::fail(ErrorCode::WrongState, "cannot open " + description_.uri + ": it is gone", "close it first");
  }
  if (state() != DeviceState::Closed) return {};
  if (auto opened = master_.device->open(); !opened) return pass_on(opened.error(), "first");
  if (auto opened = slave_.device->open(); !opened) {
    (void)master_.device->close();
    return pass_on(opened.error(), "second");
  }
  move_to(DeviceState::Open);
  return {};
}

core::Result<core::Rate> JoinedPair::start(const StartOptions& options) {
  const std::string what = "cannot start " + description_.uri;
  if (state() == DeviceState::Gone) return core::fail(ErrorCode::DeviceGone, what + ": it is gone");
  if (state() == DeviceState::Closed) return core::fail(ErrorCode::WrongState, what + ": it is not open");
  if (state() == DeviceState::Streaming) return core::fail(ErrorCode::WrongState, what + ": it is streaming already");
  DTS_TRY(check_start(description_, options));
  auto started = start_halves(options);
  if (!started) {
    (void)master_.device->stop();
    (void)slave_.device->stop();
    if (started.error().code == ErrorCode::DeviceGone) move_to(DeviceState::Gone);
    return started;
  }
  move_to(DeviceState::Streaming);
  return started;
}

/// Stops the master with certainty: a stop request may have been lost.
core::Status JoinedPair::silence_master() {
  const core::Status confirmed = confirm_master_stopped_();
  if (confirmed) return {};
  if (confirmed.error().code == ErrorCode::DeviceGone) return pass_on(confirmed.error(), "first");
  (void)close();
  DTS_TRY(open());
  if (auto again = confirm_master_stopped_(); !again) return pass_on(again.error(), "first");
  return {};
}

core::Result<core::Rate> JoinedPair::start_halves(const StartOptions& options) {
  max_block_scans_ = options.max_block_scans;
  for (Half* half : {&master_, &slave_}) {
    const std::size_t channels = half->device->describe().channels.size();
    half->fresh = core::Block(channels, max_block_scans_);
    half->waiting = core::Block(channels, 2 * max_block_scans_);
  }
  broken_.reset();
  alone_since_ns_.reset();
  has_missed_pulses_.store(false, std::memory_order_release);  // pairs with report
  is_interrupted_.store(false, std::memory_order_relaxed);
  // The slave must receive the first pulse of the new scan, and no earlier pulse.
  DTS_TRY(silence_master());
  if (auto started = slave_.device->start(options); !started) return pass_on(started.error(), "second");
  auto started = master_.device->start(options);
  if (!started) return pass_on(started.error(), "first");
  rate_ = *started;
  lag_limit_ns_ = kLagNs + rate_.time_ns({kMostPacketsApart * kPacketCodes});
  // Only units with the same number of channels fill their packets at the same instants.
  const bool are_alike = master_.waiting.channel_count() == slave_.waiting.channel_count();
  wait_limit_ns_ = rate_.time_ns({1}) / 2 + kFrameNs + (are_alike ? 0 : kTransferNs);
  begin_window();
  return started;
}

ReadResult JoinedPair::read(core::Block& block, std::int64_t deadline_ns) noexcept {
  block.set_count(0);
  if (state() == DeviceState::Gone) return {ReadOutcome::Gone, {core::GapReason::Unplugged, 0, false}};
  if (state() != DeviceState::Streaming) return {};
  if (broken_) return *broken_;
  if (block.capacity() == 0 || block.channel_count() != description_.channels.size()) return {ReadOutcome::Timeout, {}};

  const std::size_t wanted = std::min(block.capacity(), max_block_scans_);
  while (true) {
    if (const auto fault = collect_both(wanted, deadline_ns)) return end_with(*fault);
    const std::size_t scans = std::min({wanted, master_.waiting.count(), slave_.waiting.count()});
    const std::int64_t now_ns = clock_.now_ns();
    if (scans > 0) {
      if (is_one_behind(scans)) return end_with({ReadOutcome::Broken, {core::GapReason::Integrity, 0, false}});
      merge(block, scans);
      return {ReadOutcome::Scans, {}};
    }
    if (is_one_alone(now_ns)) return end_with({ReadOutcome::Broken, {core::GapReason::Silence, 0, false}});
    const bool is_over = is_interrupted_.exchange(false, std::memory_order_acquire) || now_ns >= deadline_ns;  // pairs with interrupt
    if (is_over) return {master_.outcome == ReadOutcome::Armed ? ReadOutcome::Armed : ReadOutcome::Timeout, {}};
  }
}

/// Collects up to `wanted` scans from one half, then the same number from the other half.
std::optional<ReadResult> JoinedPair::collect_both(std::size_t wanted, std::int64_t deadline_ns) noexcept {
  Half& first = is_slave_first_ ? slave_ : master_;
  Half& second = is_slave_first_ ? master_ : slave_;
  is_slave_first_ = !is_slave_first_;
  if (const auto fault = collect(first, wanted, std::min(deadline_ns, clock_.now_ns() + lag_limit_ns_))) return fault;
  const std::size_t ready = std::min(wanted, first.waiting.count());
  const std::int64_t before_ns = clock_.now_ns();
  // If the first half has no scans, read the second half only once, without waiting, to find its faults.
  const std::int64_t until_ns = ready == 0 ? before_ns : std::min(deadline_ns, before_ns + lag_limit_ns_);
  if (const auto fault = collect(second, std::max<std::size_t>(ready, 1), until_ns)) return fault;
  if (ready > 0) note_wait(second, clock_.now_ns() - before_ns);
  return std::nullopt;
}

/// Reads until the half has `scans` waiting scans, until the deadline, or until an interrupt. Returns a result only if the half has failed.
std::optional<ReadResult> JoinedPair::collect(Half& half, std::size_t scans, std::int64_t deadline_ns) noexcept {
  while (half.waiting.count() < scans) {
    // `fresh` has the size of the largest block: for fewer scans, the deadline limits the read.
    const std::size_t missing = scans - half.waiting.count();
    const std::int64_t until_ns = missing < half.fresh.capacity() ? clock_.now_ns() + rate_.time_ns({missing}) : deadline_ns;
    const ReadResult result = half.device->read(half.fresh, std::min(until_ns, deadline_ns));
    half.outcome = result.outcome;
    if (result.outcome == ReadOutcome::Scans) {
      append(half);
    } else if (result.outcome != ReadOutcome::Timeout && result.outcome != ReadOutcome::Armed) {
      return result;
    }
    if (clock_.now_ns() >= deadline_ns || is_interrupted_.load(std::memory_order_acquire)) break;  // pairs with interrupt
  }
  return std::nullopt;
}

void JoinedPair::append(Half& half) noexcept {
  core::Block& waiting = half.waiting;
  const std::size_t before = waiting.count();
  const std::size_t more = std::min(half.fresh.count(), waiting.capacity() - before);
  if (before == 0) waiting.copy_position(half.fresh);
  waiting.set_count(before + more);
  for (std::size_t channel = 0; channel < waiting.channel_count(); ++channel) {
    std::copy_n(half.fresh.column(channel).begin(), more, waiting.column(channel).begin() + static_cast<std::ptrdiff_t>(before));
    std::copy_n(half.fresh.quality(channel).begin(), more, waiting.quality(channel).begin() + static_cast<std::ptrdiff_t>(before));
  }
}

void JoinedPair::drop_front(Half& half, std::size_t scans) noexcept {
  core::Block& waiting = half.waiting;
  const auto first = static_cast<std::ptrdiff_t>(scans);
  for (std::size_t channel = 0; channel < waiting.channel_count(); ++channel) {
    std::copy(waiting.column(channel).begin() + first, waiting.column(channel).end(), waiting.column(channel).begin());
    std::copy(waiting.quality(channel).begin() + first, waiting.quality(channel).end(), waiting.quality(channel).begin());
  }
  waiting.first_scan = waiting.first_scan + scans;
  waiting.host_time_ns += rate_.time_ns({scans});
  waiting.set_count(waiting.count() - scans);
}

void JoinedPair::merge(core::Block& block, std::size_t scans) noexcept {
  alone_since_ns_.reset();
  block.copy_position(master_.waiting);
  block.set_count(scans);
  copy_columns(master_.waiting, block, 0, scans);
  copy_columns(slave_.waiting, block, master_.waiting.channel_count(), scans);
  drop_front(master_, scans);
  drop_front(slave_, scans);
}

void JoinedPair::note_wait(Half& half, std::int64_t wait_ns) noexcept {
  half.shortest_wait_ns = std::min(half.shortest_wait_ns, wait_ns);
  ++half.waits;
}

void JoinedPair::begin_window() noexcept {
  window_scans_ = 0;
  for (Half* half : {&master_, &slave_}) {
    half->shortest_wait_ns = std::numeric_limits<std::int64_t>::max();
    half->waits = 0;
  }
}

/// Counts the `scans` to deliver; at the end of a window, returns true if the waits show that one unit is behind.
bool JoinedPair::is_one_behind(std::size_t scans) noexcept {
  window_scans_ += scans;
  if (window_scans_ < rate_.scans_in_ms(kWindowMs) || std::min(master_.waits, slave_.waits) < kFewestWaits) return false;
  const bool is_behind = std::max(master_.shortest_wait_ns, slave_.shortest_wait_ns) > wait_limit_ns_;
  begin_window();
  return is_behind;
}

bool JoinedPair::is_one_alone(std::int64_t now_ns) noexcept {
  const bool is_alone = (master_.waiting.count() > 0) != (slave_.waiting.count() > 0);
  if (!is_alone) alone_since_ns_.reset();
  if (is_alone && !alone_since_ns_) alone_since_ns_ = now_ns;
  return is_alone && now_ns - *alone_since_ns_ >= lag_limit_ns_;
}

/// Finds the cause of a silence by reading the master. If the master has scans, the slave does not receive pulses.
ReadResult JoinedPair::cause_of(const ReadResult& fault) noexcept {
  if (fault.outcome == ReadOutcome::Gone || fault.gap.reason != core::GapReason::Silence) return fault;
  std::size_t master_scans = master_.waiting.count();
  for (int i = 0; i < kMostBlocksBehind; ++i) {
    const ReadResult result = master_.device->read(master_.fresh, clock_.now_ns());
    if (result.outcome == ReadOutcome::Broken || result.outcome == ReadOutcome::Gone) return result;
    if (result.outcome != ReadOutcome::Scans) break;
    master_scans += master_.fresh.count();
  }
  // If the master falls silent, the slave falls silent at the same time.
  if (master_scans > slave_.waiting.count() + rate_.scans_in_ms(kMissedPulsesMs))
    has_missed_pulses_.store(true, std::memory_order_release);  // pairs with report
  return fault;
}

/// Ends the scan: a fault of one unit is a fault of the pair. A gap of one unit is a fault too: it would shift this unit against the other.
ReadResult JoinedPair::end_with(const ReadResult& seen) noexcept {
  const ReadResult fault = cause_of(seen);
  if (fault.outcome == ReadOutcome::Gone) {
    move_to(DeviceState::Gone);
    return fault;
  }
  const core::GapReason reason = fault.gap.reason == core::GapReason::None ? core::GapReason::Integrity : fault.gap.reason;
  broken_ = ReadResult{ReadOutcome::Broken, {reason, 0, false}};
  return *broken_;
}

void JoinedPair::interrupt() noexcept {
  is_interrupted_.store(true, std::memory_order_release);  // pairs with collect
  master_.device->interrupt();
  slave_.device->interrupt();
}

core::Status JoinedPair::set_sync_output(bool is_high) {
  const DeviceState now = state();
  if (now == DeviceState::Gone || now == DeviceState::Closed) return refuse_sync_output(description_, now);
  return master_.device->set_sync_output(is_high);
}

core::Status JoinedPair::stop() {
  if (state() != DeviceState::Streaming) return {};
  const core::Status first = master_.device->stop();
  const core::Status second = slave_.device->stop();
  const bool is_lost = master_.device->state() == DeviceState::Gone || slave_.device->state() == DeviceState::Gone;
  move_to(is_lost ? DeviceState::Gone : DeviceState::Open);
  return first ? second : first;
}

core::Status JoinedPair::close() {
  const core::Status first = master_.device->close();
  const core::Status second = slave_.device->close();
  move_to(DeviceState::Closed);
  return first ? second : first;
}

}  // namespace dts::device::mcc
