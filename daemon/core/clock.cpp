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

/// Returns one clock minus another at this moment. The other one is read before and after the first: a preemption in between would add its
/// whole duration to the difference, so a reading that took long is repeated.
template <class Read, class ReadOther>
std::int64_t difference_ns(Read read, ReadOther read_other) noexcept {
  constexpr std::int64_t kUndisturbedNs = 20'000;
  constexpr int kTries = 4;
  std::int64_t narrowest_ns = std::numeric_limits<std::int64_t>::max();
  std::int64_t difference_ns = 0;
  for (int i = 0; i < kTries && narrowest_ns > kUndisturbedNs; ++i) {
    const std::int64_t before_ns = read_other();
    const std::int64_t now_ns = read();
    const std::int64_t between_ns = read_other() - before_ns;
    if (between_ns >= narrowest_ns) continue;
    narrowest_ns = between_ns;
    difference_ns = now_ns - (before_ns + between_ns / 2);
  }
  return difference_ns;
}

}  // namespace

std::int64_t SystemClock::now_ns() const noexcept { return read_ns(CLOCK_MONOTONIC); }

void SystemClock::sleep_until_ns(std::int64_t deadline_ns) noexcept {
  const timespec until{deadline_ns / kNanosecondsPerSecond, deadline_ns % kNanosecondsPerSecond};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

std::int64_t SystemClock::raw_ns() const noexcept { return read_ns(CLOCK_MONOTONIC_RAW); }

std::int64_t SystemClock::suspended_ns() const noexcept {
  return difference_ns([] { return read_ns(CLOCK_BOOTTIME); }, [] { return read_ns(CLOCK_MONOTONIC); });
}

std::int64_t monotonic_of_raw_ns(const Clock& clock, std::int64_t raw_ns) noexcept {
  return raw_ns + difference_ns([&] { return clock.now_ns(); }, [&] { return clock.raw_ns(); });
}

std::int64_t Clock::utc_minus_monotonic_ns() const noexcept {
  return difference_ns([] { return read_ns(CLOCK_REALTIME); }, [] { return read_ns(CLOCK_MONOTONIC); });
}

}  // namespace dts::core
