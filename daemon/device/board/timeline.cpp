// SPDX-License-Identifier: Apache-2.0
#include "device/board/timeline.h"

#include <algorithm>
#include <cmath>

namespace dts::device::board {
namespace {

constexpr std::int64_t kFrameNs = 1'000'000;  // a USB frame of the adapter; a serial line itself adds some 100 us
constexpr double kLargestTickError = 0.01;    // as the largest error of a rate
constexpr double kTickJitterS = 0.05;         // of boards that scan in a loop
constexpr double kTickJitterPart = 0.75;      // of a period, at low rates
constexpr double kTickDriftKnownS = 10.0;
constexpr double kTickWindowS = 10.0;  // in which small differences add up

}  // namespace

void Timeline::start(core::Rate rate, std::uint32_t ticks_per_second, bool is_same_clock,
                     std::optional<std::int64_t> not_before_ns) noexcept {
  if (!is_same_clock || rate != rate_ || ticks_per_second != ticks_per_second_) {
    rate_ = rate;
    ticks_per_second_ = ticks_per_second;
    const auto tick_rate = core::Rate::create(std::max<std::int64_t>(1, ticks_per_second), 1);
    host_time_ = core::HostTime(ticks_per_second == 0 || !tick_rate ? rate : *tick_rate, kFrameNs, core::HostTime::Oscillator::Resonator);
  }
  restart();
  host_time_.restart(not_before_ns);
}

void Timeline::restart() noexcept {
  host_time_.restart();
  has_scans_ = false;
  first_position_ = 0;
  newest_position_ = 0;
  ticks_ppm_ = 0.0;
}

/// Returns the ticks that a number of scans takes; without ticks their number. Long double: 2^32 scans by 2^32 ticks per second.
std::uint64_t Timeline::ticks_in(std::uint64_t scans) const noexcept {
  if (ticks_per_second_ == 0) return scans;
  const long double ticks = static_cast<long double>(scans) * ticks_per_second_ * static_cast<long double>(rate_.denominator()) /
                            static_cast<long double>(rate_.numerator());
  return static_cast<std::uint64_t>(ticks + 0.5L);
}

/// Returns true if a number of ticks is the time of a number of scans: not exactly, because a rate may be slightly wrong, and a loop
/// uneven.
bool Timeline::agree(std::uint64_t ticks, std::uint64_t scans) const noexcept {
  const double elapsed_s = static_cast<double>(ticks) / ticks_per_second_;
  const double expected_s = static_cast<double>(ticks_in(scans)) / ticks_per_second_;
  const double jitter_s = std::max(kTickJitterS, kTickJitterPart * static_cast<double>(period_ns()) * 1e-9);
  return std::abs(elapsed_s - expected_s) <= kLargestTickError * expected_s + jitter_s;
}

bool Timeline::add(std::uint64_t number, std::uint32_t ticks, std::size_t count, std::int64_t arrived_ns) noexcept {
  if (!has_scans_) {
    first_number_ = number;
    first_position_ = 0;
  } else if (ticks_per_second_ == 0) {
    first_position_ = number - first_number_;
  } else {
    // The time since the last frame is whole turns of the ticks, as the counter says, and what the ticks say.
    const std::uint64_t expected = ticks_in(number - last_number_);
    const std::uint64_t turn = 1ULL << 32U;
    std::uint64_t step = ticks - last_ticks_;
    if (expected > step) step += (expected - step + turn / 2) / turn * turn;
    first_position_ += step;
    if (!agree(step, number - last_number_) || !agree(first_position_ - window_position_, number - window_number_)) return false;
    const double elapsed_s = static_cast<double>(first_position_) / ticks_per_second_;
    const double expected_s = static_cast<double>(ticks_in(number - first_number_)) / ticks_per_second_;
    if (elapsed_s >= kTickDriftKnownS) ticks_ppm_ = (expected_s / elapsed_s - 1.0) * 1e6;
  }
  const bool begins_window = static_cast<double>(first_position_ - window_position_) >= kTickWindowS * ticks_per_second_;
  if (!has_scans_ || begins_window) {
    window_number_ = number;
    window_position_ = first_position_;
  }
  has_scans_ = true;
  last_number_ = number;
  last_ticks_ = ticks;
  newest_position_ = std::max(newest_position_, position(count - 1));
  host_time_.add({newest_position_}, arrived_ns);
  return true;
}

std::uint64_t Timeline::estimate_missing(std::size_t count, std::int64_t arrived_ns) noexcept {
  if (!has_scans_) return 0;
  const auto period_ns = static_cast<double>(rate_.time_ns({1'000'000})) * 1e-6;
  const double between_ns = static_cast<double>(arrived_ns - raw_ns_at(newest_position_));
  const double scans = std::round(between_ns / period_ns) - static_cast<double>(count);
  return scans > 0.0 ? static_cast<std::uint64_t>(std::min(scans, 1e15)) : 0;
}

}  // namespace dts::device::board
