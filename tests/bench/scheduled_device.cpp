// SPDX-License-Identifier: Apache-2.0
#include "bench/scheduled_device.h"

#include <algorithm>
#include <limits>

namespace dts::bench {
namespace {

using device::DeviceState;
using device::ReadOutcome;

constexpr std::int64_t kSliceNs = 50 * core::kNanosecondsPerMillisecond;  // interrupt() must be noticed within 100 ms
constexpr double kRangeV = 5.0;

}  // namespace

ScheduledDevice::ScheduledDevice(const Plan& plan, std::size_t channels, core::Rate rate, std::int64_t tick_ns, core::Clock& clock)
    : plan_(plan), rate_(rate), tick_ns_(tick_ns), clock_(clock) {
  description_.uri = "bench:schedule";
  description_.model = "Producer's schedule of a benchmark";
  description_.minimum_rate_hz = 0.0;
  description_.maximum_rate_hz = std::numeric_limits<double>::max();
  for (std::size_t channel = 0; channel < channels; ++channel) {
    description_.channels.push_back({.name = "ch" + std::to_string(channel), .unit = "V", .minimum = -kRangeV, .maximum = kRangeV});
  }
}

core::Status ScheduledDevice::open() {
  state_ = DeviceState::Open;
  return {};
}

core::Result<core::Rate> ScheduledDevice::start(const device::StartOptions&) {
  state_ = DeviceState::Streaming;
  return rate_;
}

core::Status ScheduledDevice::stop() {
  state_ = DeviceState::Open;
  return {};
}

core::Status ScheduledDevice::close() {
  state_ = DeviceState::Closed;
  return {};
}

std::int64_t ScheduledDevice::due_ns(std::int64_t begin_ns) noexcept {
  if (begin_ns == 0 || message_ == plan_.total_messages) return std::numeric_limits<std::int64_t>::max();
  const double period_ns = 1e9 * static_cast<double>(plan_.chunk) / plan_.rate_hz;
  const std::int64_t due = begin_ns + static_cast<std::int64_t>(static_cast<double>(message_) * period_ns);
  if (tick_ns_ == 0) return due;
  if (due > next_tick_ns_) next_tick_ns_ = begin_ns + (due - begin_ns + tick_ns_ - 1) / tick_ns_ * tick_ns_;
  return next_tick_ns_;
}

device::ReadResult ScheduledDevice::read(core::Block& block, std::int64_t deadline_ns) noexcept {
  block.set_count(0);
  if (state_ != DeviceState::Streaming) return {};
  note_progress();
  note_turn();
  const std::int64_t due = due_ns(begin_ns_.load(std::memory_order_acquire));  // pairs with begin()
  std::int64_t now_ns = clock_.now_ns();
  while (now_ns < due) {
    if (now_ns >= deadline_ns || is_interrupted_.exchange(false, std::memory_order_acquire)) return {ReadOutcome::Timeout, {}};
    clock_.sleep_until_ns(std::min({due, deadline_ns, now_ns + kSliceNs}));
    now_ns = clock_.now_ns();
    if (due == std::numeric_limits<std::int64_t>::max()) return {ReadOutcome::Timeout, {}};  // begin() may have been called
  }
  if (message_ >= plan_.warm_messages) latest_ns_ = std::max(latest_ns_, now_ns - due);
  fill(block);
  ++message_;
  handed_over_ns_ = clock_.now_ns();
  return {ReadOutcome::Scans, {}};
}

bool ScheduledDevice::has_more() noexcept {
  return message_ < plan_.total_messages && clock_.now_ns() >= due_ns(begin_ns_.load(std::memory_order_acquire));  // pairs with begin()
}

void ScheduledDevice::note_progress() noexcept {
  if (message_ == plan_.warm_messages && use_at_begin_.at_ns == 0) use_at_begin_ = ProcessUse::now(clock_.now_ns());
  if (message_ != plan_.total_messages || use_at_end_.at_ns != 0) return;
  use_at_end_ = ProcessUse::now(clock_.now_ns());
  is_done_.store(true, std::memory_order_release);  // pairs with is_done()
}

void ScheduledDevice::note_turn() noexcept {
  if (message_ > plan_.warm_messages && handed_over_ns_ != 0)
    longest_turn_ns_ = std::max(longest_turn_ns_, clock_.now_ns() - handed_over_ns_);
  handed_over_ns_ = 0;
}

void ScheduledDevice::fill(core::Block& block) noexcept {
  block.set_count(plan_.chunk);
  const std::size_t scans = block.count();
  for (std::size_t channel = 0; channel < block.channel_count(); ++channel) {
    for (double& volts : block.column(channel)) {
      random_ = random_ * 1664525U + 1013904223U;  // the constants of Numerical Recipes' quick generator
      volts = (static_cast<double>(random_ >> 8U) / 16777216.0 - 0.5) * kRangeV;
    }
    std::ranges::fill(block.quality(channel), std::uint8_t{0});
  }
  block.first_scan = {message_ * plan_.chunk};
  block.host_time_ns = clock_.now_ns() - rate_.time_ns({scans - 1});  // last: making the data is not part of the latency
}

}  // namespace dts::bench
