// SPDX-License-Identifier: Apache-2.0
#include "core/clock.h"

#include <ctime>

#include <cerrno>
#include <limits>

namespace dts::core {
namespace {

std::int64_t read_ns(clockid_t id) noexcept {
  timespec now{};
  clock_gettime(id, &now);
  return static_cast<std::int64_t>(now.tv_sec) * kNanosecondsPerSecond + now.tv_nsec;
}

}  // namespace

std::int64_t SystemClock::now_ns() const noexcept { return read_ns(CLOCK_MONOTONIC); }

void SystemClock::sleep_until_ns(std::int64_t deadline_ns) noexcept {
  const timespec until{deadline_ns / kNanosecondsPerSecond, deadline_ns % kNanosecondsPerSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

std::int64_t SystemClock::raw_ns() const noexcept { return read_ns(CLOCK_MONOTONIC_RAW); }

std::int64_t SystemClock::suspended_ns() const noexcept { return read_ns(CLOCK_BOOTTIME) - read_ns(CLOCK_MONOTONIC); }

std::int64_t monotonic_of_raw_ns(const Clock& clock, std::int64_t raw_ns) noexcept {
  constexpr std::int64_t kUndisturbedNs = 20'000;
  constexpr int kTries = 4;
  // One clock is read between two readings of the other: a preemption in between would add its whole duration to the difference, so a
  // reading that took long is repeated.
  std::int64_t narrowest_ns = std::numeric_limits<std::int64_t>::max();
  std::int64_t difference_ns = 0;
  for (int i = 0; i < kTries && narrowest_ns > kUndisturbedNs; ++i) {
    const std::int64_t before_ns = clock.raw_ns();
    const std::int64_t now_ns = clock.now_ns();
    const std::int64_t between_ns = clock.raw_ns() - before_ns;
    if (between_ns >= narrowest_ns) continue;
    narrowest_ns = between_ns;
    difference_ns = now_ns - (before_ns + between_ns / 2);
  }
  return raw_ns + difference_ns;
}

std::int64_t Clock::utc_minus_monotonic_ns() const noexcept { return read_ns(CLOCK_REALTIME) - read_ns(CLOCK_MONOTONIC); }

}  // namespace dts::core
