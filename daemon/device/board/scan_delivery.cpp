// SPDX-License-Identifier: Apache-2.0
#include "device/board/scan_delivery.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace dts::device::board {
namespace {

using bytes::ReadEnd;
using core::GapReason;

constexpr std::int64_t kMsNs = core::kNanosecondsPerMillisecond;
constexpr std::int64_t kDeliverySliceNs = 50 * kMsNs;  // read() sees interrupt() within 100 ms
constexpr std::int64_t kQuestionNs = 500 * kMsNs;
constexpr double kLargestRateError = 0.01;

}  // namespace

ScanDelivery::ScanDelivery(ScanSource& source, core::Clock& clock, std::atomic<bool>& is_interrupted, std::size_t max_block_scans)
    : source_(source),
      clock_(clock),
      is_interrupted_(is_interrupted),
      max_block_scans_(max_block_scans),
      published_ns_(std::numeric_limits<std::int64_t>::min()) {}

ReadResult ScanDelivery::read(core::Block& block, std::int64_t deadline_ns) noexcept {
  block.set_count(0);
  // A block of the wrong size is a mistake of the caller; it must not cause writes beyond a column.
  if (block.capacity() == 0 || block.channel_count() != source_.queue().channels()) return {ReadOutcome::Timeout, {}};
  const std::size_t wanted = std::min(block.capacity(), max_block_scans_);
  std::int64_t wait_until_ns = std::numeric_limits<std::int64_t>::min();  // first only what has arrived
  while (true) {
    const ReadEnd end = fill(wanted, wait_until_ns, std::min(deadline_ns, silent_at_ns()));
    if (end == ReadEnd::Lost) source_.set_trouble(ReadOutcome::Gone, GapReason::Unplugged);
    const std::int64_t now_ns = clock_.now_ns();
    const bool is_interrupted = is_interrupted_.exchange(false, std::memory_order_acquire);  // pairs with BoardDevice::interrupt
    const bool is_over = now_ns >= deadline_ns || is_interrupted;
    if (source_.queue().size() > 0 && (source_.queue().size() >= wanted || is_over || source_.has_trouble())) {
      deliver(block, wanted);
      return {ReadOutcome::Scans, {}};
    }
    if (source_.has_trouble()) return report_trouble();
    if (is_over) return {ReadOutcome::Timeout, {}};
    if (now_ns >= silent_at_ns()) {
      handle_silence(now_ns);
      continue;
    }
    wait_until_ns = std::min({deadline_ns, now_ns + kDeliverySliceNs, silent_at_ns()});
  }
}

/// Fills the queue with what arrives until `wait_until_ns`. A board that sends pieces without a scan keeps the caller for at most 50 ms,
/// and not beyond `limit_ns`.
ReadEnd ScanDelivery::fill(std::size_t wanted, std::int64_t wait_until_ns, std::int64_t limit_ns) noexcept {
  const std::int64_t leave_ns = std::min(limit_ns, clock_.now_ns() + kDeliverySliceNs);
  ReadEnd end = ReadEnd::Bytes;
  while (end == ReadEnd::Bytes && !source_.has_trouble() && source_.queue().size() < wanted) {
    const std::size_t before = source_.queue().size();
    end = source_.pull(wait_until_ns);
    if (end == ReadEnd::Bytes) check_rate();
    if (source_.queue().size() == before && clock_.now_ns() >= leave_ns) break;
  }
  return end;
}

/// Returns when the board counts as silent, or, after a question, when it has had time to answer.
std::int64_t ScanDelivery::silent_at_ns() noexcept {
  if (silence_ != Silence::None && source_.newest_ns() > silence_step_ns_) silence_ = Silence::None;
  const std::int64_t limit_ns = source_.silence_ns();
  switch (silence_) {
    case Silence::None: return source_.newest_ns() + limit_ns;
    case Silence::Asked: return silence_step_ns_ + kQuestionNs;
    case Silence::StartedAgain: return silence_step_ns_ + limit_ns;
  }
  return source_.newest_ns() + limit_ns;
}

void ScanDelivery::handle_silence(std::int64_t now_ns) noexcept {
  bool is_there = true;
  if (silence_ == Silence::None) {
    silence_ = Silence::Asked;
    is_there = source_.ask();
  } else if (silence_ == Silence::Asked) {
    silence_ = Silence::StartedAgain;
    is_there = source_.start_again();
  } else {
    return source_.set_trouble(ReadOutcome::Gone, GapReason::Silence);
  }
  silence_step_ns_ = now_ns;
  if (!is_there) source_.set_trouble(ReadOutcome::Gone, GapReason::Unplugged);
}

void ScanDelivery::check_rate() noexcept {
  const core::HostTime& host_time = source_.timeline().host_time();
  rate_error_.store(host_time.rate_error(), std::memory_order_relaxed);  // only for the report, as all stores here
  drift_ppm_.store(source_.timeline().drift_ppm(), std::memory_order_relaxed);
  is_judged_.store(host_time.is_judged(), std::memory_order_relaxed);
  const InputCounts counts = source_.counts();
  good_.store(counts.good, std::memory_order_relaxed);
  damaged_.store(counts.damaged + counts.too_long, std::memory_order_relaxed);
  rejected_.store(counts.rejected, std::memory_order_relaxed);
  const bool is_rate_wrong = !(std::abs(host_time.rate_error()) <= kLargestRateError);
  if (is_rate_wrong && !source_.has_trouble()) source_.break_off("the board does not scan at its rate; correct rate_hz, or its program");
}

void ScanDelivery::deliver(core::Block& block, std::size_t wanted) noexcept {
  ScanQueue& queue = source_.queue();
  const std::size_t count = std::min(queue.size(), wanted);
  Timeline& timeline = source_.timeline();
  const std::int64_t time_ns = core::monotonic_of_raw_ns(clock_, timeline.raw_ns_at(queue.position(0)));
  published_ns_ = delivered_ > 0 ? std::max(time_ns, published_ns_ + 1) : time_ns;
  block.set_count(count);
  block.first_scan = {delivered_};
  block.host_time_ns = published_ns_;
  block.host_time_uncertainty_ns = timeline.host_time().uncertainty_ns();
  block.clock_drift_ppm = timeline.drift_ppm();
  std::uint64_t outside = 0;
  for (std::size_t channel = 0; channel < queue.channels(); ++channel) {
    const std::span<double> values = block.column(channel);
    const std::span<std::uint8_t> quality = block.quality(channel);
    for (std::size_t i = 0; i < count; ++i) {
      values[i] = queue.values(i)[channel];
      quality[i] = queue.quality(i)[channel];
      if ((quality[i] & core::quality::kRail) != 0) ++outside;
    }
  }
  values_.fetch_add(count * queue.channels(), std::memory_order_relaxed);
  outside_.fetch_add(outside, std::memory_order_relaxed);
  delivered_ += count;
  queue.remove(count);
}

/// Returns the trouble. Broken and Gone are repeated; a Gap is reported once, and the stream continues after it.
ReadResult ScanDelivery::report_trouble() noexcept {
  if (source_.trouble().outcome == ReadOutcome::Gap) delivered_ = 0;
  return source_.take_trouble();
}

std::vector<DeviceCheck> ScanDelivery::findings() const {
  using enum DeviceCheck::Outcome;
  std::vector<DeviceCheck> checks;
  std::array<char, 160> text{};
  const double rate_error = rate_error_.load(std::memory_order_relaxed);
  const double drift_ppm = drift_ppm_.load(std::memory_order_relaxed);
  if (std::abs(rate_error) > kLargestRateError) {
    std::snprintf(text.data(), text.size(), "off by %.2f %% beyond what arrival jitter explains", std::abs(rate_error) * 100.0);
    checks.push_back({"the scan runs at its rate", Failed, text.data()});
  } else if (is_judged_.load(std::memory_order_relaxed)) {
    std::snprintf(text.data(), text.size(), "its clock is %.0f ppm %s", std::abs(drift_ppm), drift_ppm > 0.0 ? "fast" : "slow");
    const bool is_crystal = std::abs(drift_ppm) <= core::HostTime::kCrystalPpm;
    checks.push_back({"the scan runs at its rate", is_crystal ? Passed : Warning, text.data()});
  } else {
    checks.push_back({"the scan runs at its rate", Skipped, "needs 3 s of scans"});
  }
  if (const char* const why = source_.why_broken()) checks.push_back({kBreakOffCheck, Failed, why});
  const std::uint64_t counted = source_.losses().counted.load(std::memory_order_relaxed);
  const std::uint64_t estimated = source_.losses().estimated.load(std::memory_order_relaxed);
  std::snprintf(text.data(), text.size(), "%llu counted, %llu estimated from time", static_cast<unsigned long long>(counted),
                static_cast<unsigned long long>(estimated));
  checks.push_back({"no scans are lost since the start", counted + estimated == 0 ? Passed : Warning, text.data()});
  const std::uint64_t damaged = damaged_.load(std::memory_order_relaxed);
  const std::uint64_t rejected = rejected_.load(std::memory_order_relaxed);
  std::snprintf(text.data(), text.size(), "%llu good, %llu damaged, %llu rejected",
                static_cast<unsigned long long>(good_.load(std::memory_order_relaxed)), static_cast<unsigned long long>(damaged),
                static_cast<unsigned long long>(rejected));
  checks.push_back({"frames or lines arrive undamaged since it was opened", damaged + rejected == 0 ? Passed : Warning, text.data()});
  const std::uint64_t outside = outside_.load(std::memory_order_relaxed);
  std::snprintf(text.data(), text.size(), "%llu of %llu are outside%s", static_cast<unsigned long long>(outside),
                static_cast<unsigned long long>(values_.load(std::memory_order_relaxed)),
                outside == 0 ? "" : ": correct range in the address, or check the sensor");
  checks.push_back({"values are inside the range", outside == 0 ? Passed : Warning, text.data()});
  return checks;
}

}  // namespace dts::device::board
