// SPDX-License-Identifier: Apache-2.0
#include "device/usb/scan_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

namespace dts::device::usb {
namespace {

using core::GapReason;

constexpr std::int64_t kMillisecond = core::kNanosecondsPerMillisecond;
constexpr std::int64_t kSliceNs = 50 * kMillisecond;  // read() sees interrupt() within 100 ms
constexpr double kHeldBackMs = 50.0;
constexpr std::int64_t kShortestSilenceNs = 100 * kMillisecond;
constexpr std::int64_t kLongestSilenceNs = 200 * kMillisecond;
constexpr std::int64_t kFirstSilenceNs = 250 * kMillisecond;
constexpr std::int64_t kRunningSilenceNs =
    600 * kMillisecond;  // for a device that reports that it runs: its buffer may hold all scans of that time
constexpr double kLargestRateError = 0.01;
constexpr std::size_t kCodeBytes = 2;

std::size_t buffer_scans(const ScanSetup& setup, std::size_t channels, std::size_t held_scans) {
  const std::size_t transfer_scans = setup.shape.transfer_bytes / kCodeBytes / channels + 2;
  // Doubled: ScanBuffer moves its codes only if less than half of the buffer is free at the end.
  return 2 * (std::max(setup.max_block_scans, held_scans) + transfer_scans);
}

constexpr char kRateCheck[] = "the scan runs at its rate";
constexpr char kLossCheck[] = "no scans are missing on the way";

DeviceCheck describe_rate(double error, double drift_ppm) {
  using enum DeviceCheck::Outcome;
  std::array<char, 96> text{};
  if (!(std::abs(error) <= kLargestRateError) || std::abs(drift_ppm) <= core::HostTime::kCrystalPpm) {
    std::snprintf(text.data(), text.size(), "off by %.2f %% beyond what arrival jitter explains", std::abs(error) * 100.0);
    return {kRateCheck, std::abs(error) <= kLargestRateError ? Passed : Failed, text.data()};
  }
  const char* const direction = drift_ppm > 0.0 ? "fast" : "slow";
  std::snprintf(text.data(), text.size(), "its clock is %.0f ppm %s: more than any crystal oscillator", std::abs(drift_ppm), direction);
  return {kRateCheck, Warning, text.data()};
}

DeviceCheck describe_loss(std::int64_t missing_ns, std::int64_t limit_ns) {
  using enum DeviceCheck::Outcome;
  std::array<char, 192> text{};
  std::snprintf(text.data(), text.size(),
                "lateness rose by %.1f ms; more than %.1f ms would mean missing scans, or a device clock that is far too slow",
                static_cast<double>(missing_ns) * 1e-6, static_cast<double>(limit_ns) * 1e-6);
  return {kLossCheck, missing_ns <= limit_ns ? Passed : Failed, text.data()};
}

}  // namespace

ScanReader::ScanReader(const Tools& tools, ScanSetup setup)
    : use_(tools),
      setup_(std::move(setup)),
      channels_(tools.driver.describe().channels.size()),
      newest_data_ns_(tools.clock.now_ns()),
      published_ns_(std::numeric_limits<std::int64_t>::min()),
      held_scans_(setup_.single_v.size() == channels_ ? setup_.rate.scans_in_ms(kHeldBackMs) : 0),
      mean_v_(channels_),
      least_loss_ns_(tools.host_time.least_loss_ns()),
      marker_v_(std::numeric_limits<double>::quiet_NaN()) {
  scans_ = ScanBuffer(channels_, buffer_scans(setup_, channels_, held_scans_));
}

ReadResult ScanReader::read(core::Block& block, std::int64_t deadline_ns) noexcept {
  block.set_count(0);
  // A block of the wrong size is a mistake of the caller; it must not cause writes beyond a column.
  if (block.capacity() == 0 || block.channel_count() != channels_) return {ReadOutcome::Timeout, {}};
  const std::size_t wanted = std::min(block.capacity(), setup_.max_block_scans);
  while (true) {
    read_chunks(std::max(wanted, held_scans_));
    check_start(has_trouble());
    const std::int64_t now_ns = use_.clock.now_ns();
    const bool is_over = now_ns >= deadline_ns || use_.is_interrupted.exchange(false, std::memory_order_acquire);  // pairs with interrupt()
    const bool is_enough = scans_.scans() >= wanted || is_over || has_trouble();
    if (held_scans_ == 0 && scans_.scans() > 0 && is_enough) {
      deliver(block, wanted);
      if (block.count() > 0) return {ReadOutcome::Scans, {}};
    }
    if (has_trouble()) return report_trouble();
    if (is_over) return {nothing(), {}};
    const std::int64_t silent_at_ns = std::max(newest_data_ns_, asked_ns_) + silence_limit_ns();
    if (now_ns >= silent_at_ns && nothing() != ReadOutcome::Armed) {
      ask_silent_device(now_ns);
      continue;
    }
    const std::int64_t wait_until_ns = std::min(deadline_ns, now_ns + kSliceNs);
    use_.port.wait(nothing() == ReadOutcome::Armed ? wait_until_ns : std::min(wait_until_ns, silent_at_ns));
  }
}

ReadOutcome ScanReader::nothing() const noexcept {
  return use_.driver.waits_for_trigger() && !has_scanned_ ? ReadOutcome::Armed : ReadOutcome::Timeout;
}

/// Returns the silence after which the device is asked for its state: at most 250 ms, longer only if packets are rare (low rates).
std::int64_t ScanReader::silence_limit_ns() const noexcept {
  const std::int64_t period_ns = setup_.packet_period_ns;
  const std::int64_t usual_ns =
      has_scanned_ ? std::clamp(std::min(period_ns, kLongestSilenceNs) * 4, kShortestSilenceNs, kLongestSilenceNs) : kFirstSilenceNs;
  return std::max(usual_ns, period_ns + period_ns / 4 + 50 * kMillisecond);
}

void ScanReader::read_chunks(std::size_t wanted_scans) noexcept {
  while (!has_trouble() && scans_.scans() < wanted_scans) {
    const Chunk* const chunk = use_.stream.front();
    if (chunk == nullptr) return;
    if (use_.stream.dropped() > 0) {  // checked after `front`: the missing chunks may be before this chunk
      set_trouble(ReadOutcome::Broken, GapReason::Overrun);
      return;
    }
    const UsbStatus status = chunk->status;
    if (chunk->length > 0) newest_data_ns_ = std::max(newest_data_ns_, core::monotonic_of_raw_ns(use_.clock, chunk->stamp_ns));
    const bool has_believable_bytes = status != UsbStatus::Overflow && status != UsbStatus::Failed;
    if (has_believable_bytes && !add_bytes(*chunk)) return;
    note_arrival(chunk->stamp_ns);
    if (!has_trouble()) handle_status(status);
    chunk_used_ = 0;
    use_.stream.release();
  }
}

/// Returns false if the stream has a fault inside this chunk; the rest of the chunk is kept for after a Gap.
bool ScanReader::add_bytes(const Chunk& chunk) noexcept {
  while (chunk_used_ < chunk.length) {
    const std::size_t scans_before = scans_.scans();
    const std::span<std::uint16_t> room = scans_.room();
    const Unpacked unpacked = use_.driver.unpack({chunk.bytes.data() + chunk_used_, chunk.length - chunk_used_}, room);
    scans_.add(unpacked.codes);
    chunk_used_ = std::min(chunk_used_ + unpacked.bytes, chunk.length);
    arrived_ += scans_.scans() - scans_before;
    if (unpacked.fault != GapReason::None) {
      note_arrival(chunk.stamp_ns);
      scans_.drop_incomplete();
      trouble_ = {ReadOutcome::Broken, {unpacked.fault, 0, false}};
      if (unpacked.goes_on) trouble_ = {ReadOutcome::Gap, {unpacked.fault, unpacked.discarded_scans, true}};
      return false;
    }
    if (unpacked.bytes == 0) {  // a mistake of the driver: it would loop forever
      set_trouble(ReadOutcome::Broken, GapReason::Integrity);
      return false;
    }
  }
  return true;
}

void ScanReader::note_arrival(std::int64_t stamp_ns) noexcept {
  if (arrived_ == timed_) return;  // no complete scan has arrived
  timed_ = arrived_;
  has_scanned_ = true;
  use_.host_time.add({arrived_ - 1}, stamp_ns);
  is_judged_.store(use_.host_time.is_judged(), std::memory_order_relaxed);  // only for the report
  rate_error_.store(use_.host_time.rate_error(), std::memory_order_relaxed);
  drift_ppm_.store(use_.host_time.drift_ppm(), std::memory_order_relaxed);
  missing_ns_.store(use_.host_time.missing_ns(), std::memory_order_relaxed);
  least_loss_ns_.store(use_.host_time.least_loss_ns(), std::memory_order_relaxed);
  if (has_trouble()) return;
  const bool is_rate_wrong = !(std::abs(use_.host_time.rate_error()) <= kLargestRateError);
  if (is_rate_wrong || use_.host_time.has_loss()) set_trouble(ReadOutcome::Broken, GapReason::Integrity);
}

/// Ends the scan if the transfer did not end as Completed.
void ScanReader::handle_status(UsbStatus status) noexcept {
  if (status == UsbStatus::Completed) return;
  use_.transfer_errors[static_cast<std::size_t>(status)].fetch_add(1, std::memory_order_relaxed);  // only for the report
  if (status == UsbStatus::NoDevice) return set_trouble(ReadOutcome::Gone, GapReason::Unplugged);
  const auto asked = health();
  if (!asked && asked.error().code == core::ErrorCode::DeviceGone) return set_trouble(ReadOutcome::Gone, GapReason::Unplugged);
  if (asked && asked->is_overrun) return set_trouble(ReadOutcome::Broken, GapReason::Overrun);
  if (status == UsbStatus::Stall) return set_trouble(ReadOutcome::Broken, GapReason::Stall);
  const bool has_lost_bytes = status == UsbStatus::Overflow || status == UsbStatus::Failed || status == UsbStatus::NoMemory;
  set_trouble(ReadOutcome::Broken, has_lost_bytes ? GapReason::Integrity : GapReason::Silence);
}

core::Result<ScanHealth> ScanReader::health() noexcept {
  const std::lock_guard lock(use_.request_mutex);
  return use_.driver.health(use_.port);
}

void ScanReader::ask_silent_device(std::int64_t now_ns) noexcept {
  const auto asked = health();
  const Chunk* const chunk = use_.stream.front();
  if (chunk != nullptr &&
      (chunk->length > 0 || chunk->status != UsbStatus::Completed)) {  // only the host was late, the device was not silent
    newest_data_ns_ = now_ns;
    return;
  }
  if (!asked && asked.error().code == core::ErrorCode::DeviceGone) return set_trouble(ReadOutcome::Gone, GapReason::Unplugged);
  if (asked && asked->is_overrun) return set_trouble(ReadOutcome::Broken, GapReason::Overrun);
  // After the first request the scan continues if the device runs: if the host itself was stopped, late data may still arrive.
  const bool is_first_question = asked_ns_ <= newest_data_ns_;
  const bool is_silent_for_long = now_ns - newest_data_ns_ >= std::max(kRunningSilenceNs, 2 * silence_limit_ns());
  const bool may_go_on = asked && asked->is_running && (is_first_question || !is_silent_for_long);
  if (may_go_on) {
    asked_ns_ = now_ns;
  } else {
    set_trouble(ReadOutcome::Broken, GapReason::Silence);
  }
}

/// Compares the first scans with the single readings. `is_final`: no more scans will arrive.
void ScanReader::check_start(bool is_final) noexcept {
  const std::size_t count = scans_.scans();
  if (held_scans_ == 0 || count == 0 || (count < held_scans_ && !is_final)) return;
  std::fill(mean_v_.begin(), mean_v_.end(), 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::span<const std::uint16_t> scan = scans_.scan(i);
    for (std::size_t channel = 0; channel < channels_; ++channel) mean_v_[channel] += use_.driver.volts(channel, scan[channel]);
  }
  for (double& mean : mean_v_) mean /= static_cast<double>(count);
  agreement_ = compare_with_single_readings(setup_.single_v, mean_v_);
  has_agreement_.store(true, std::memory_order_release);  // pairs with findings()
  held_scans_ = 0;
  if (agreement_.is_rotated) doubt_the_rest();
}

bool ScanReader::is_marker_right(std::size_t scan) noexcept {
  const Marker& marker = *setup_.marker;
  const double volts = use_.driver.volts(marker.position, scans_.scan(scan)[marker.position]);
  marker_v_.store(volts, std::memory_order_relaxed);  // only for the report
  return std::abs(volts - marker.volts) <= marker.tolerance_v;
}

void ScanReader::deliver(core::Block& block, std::size_t wanted_scans) noexcept {
  const std::size_t waiting = std::min(scans_.scans(), wanted_scans);
  std::size_t count = setup_.marker ? 0 : waiting;
  while (count < waiting && is_marker_right(count)) ++count;
  block.set_count(count);
  if (count > 0) {
    block.first_scan = {delivered_};
    block.host_time_ns = host_time_ns();
    block.host_time_uncertainty_ns = use_.host_time.uncertainty_ns();
    block.clock_drift_ppm = use_.host_time.drift_ppm();
  }
  for (std::size_t channel = 0; channel < channels_; ++channel) {
    const std::span<double> values = block.column(channel);
    const std::span<std::uint8_t> quality = block.quality(channel);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint16_t code = scans_.scan(i)[channel];
      values[i] = use_.driver.volts(channel, code);
      quality[i] = use_.driver.is_rail(channel, code) ? core::quality::kRail : std::uint8_t{0};
    }
  }
  delivered_ += count;
  scans_.remove(count);
  if (count < waiting) doubt_the_rest();
}

/// Returns the host time of the next scan to deliver, by `now_ns`.
std::int64_t ScanReader::host_time_ns() noexcept {
  const std::int64_t time_ns = core::monotonic_of_raw_ns(use_.clock, use_.host_time.at({delivered_}));
  published_ns_ = delivered_ > 0 ? std::max(time_ns, published_ns_ + 1) : time_ns;
  return published_ns_;
}

/// Discards the waiting scans and ends the scan as Broken: the data are not reliable.
void ScanReader::doubt_the_rest() noexcept {
  scans_.clear();
  if (trouble_.outcome != ReadOutcome::Gone) set_trouble(ReadOutcome::Broken, GapReason::Integrity);
}

/// Returns the trouble. Broken and Gone are repeated; a Gap is reported once, and the stream continues after it.
ReadResult ScanReader::report_trouble() noexcept {
  if (trouble_.outcome != ReadOutcome::Gap) return trouble_;
  arrived_ = 0;
  timed_ = 0;
  delivered_ = 0;
  use_.host_time.restart();
  return std::exchange(trouble_, {ReadOutcome::Scans, {}});
}

std::optional<core::GapReason> ScanReader::break_reason() const noexcept {
  if (trouble_.outcome != ReadOutcome::Broken) return std::nullopt;
  return trouble_.gap.reason;
}

std::vector<DeviceCheck> ScanReader::findings() const {
  using enum DeviceCheck::Outcome;
  std::vector<DeviceCheck> checks;
  if (has_agreement_.load(std::memory_order_acquire)) {  // pairs with check_start
    checks.push_back(describe_agreement(agreement_, use_.driver.describe()));
  }
  const double rate_error = rate_error_.load(std::memory_order_relaxed);
  const std::int64_t missing_ns = missing_ns_.load(std::memory_order_relaxed);
  const std::int64_t least_loss_ns = least_loss_ns_.load(std::memory_order_relaxed);
  const bool is_in_doubt = std::abs(rate_error) > kLargestRateError || missing_ns > least_loss_ns;
  if (is_judged_.load(std::memory_order_relaxed) || is_in_doubt) {
    checks.push_back(describe_rate(rate_error, drift_ppm_.load(std::memory_order_relaxed)));
    checks.push_back(describe_loss(missing_ns, least_loss_ns));
  } else {
    for (const char* const check : {kRateCheck, kLossCheck}) checks.push_back({check, Skipped, "needs 3 s of scans"});
  }
  const double marker_v = marker_v_.load(std::memory_order_relaxed);
  if (setup_.marker && !std::isnan(marker_v)) {
    const bool is_right = std::abs(marker_v - setup_.marker->volts) <= setup_.marker->tolerance_v;
    std::array<char, 96> text{};
    std::snprintf(text.data(), text.size(), "%.3f V, expected %.3f V", marker_v, setup_.marker->volts);
    checks.push_back({"the marker is last in every scan", is_right ? Passed : Failed, text.data()});
  }
  return checks;
}

}  // namespace dts::device::usb
