// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

namespace dts::core {

inline constexpr std::int64_t kNanosecondsPerMillisecond = 1'000'000;
inline constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

/// Source of time, passed to every user: no other file reads a system clock.
/// Thread: any. Realtime-safe: yes.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Returns monotonic time (CLOCK_MONOTONIC on Linux), ns.
  [[nodiscard]] virtual std::int64_t now_ns() const noexcept = 0;
  /// Sleeps until `now_ns` reaches `deadline_ns`; never returns earlier.
  virtual void sleep_until_ns(std::int64_t deadline_ns) noexcept = 0;
  /// Returns the time of the host's crystal without slewing, ns: CLOCK_MONOTONIC_RAW on Linux, with its own origin. `now_ns` is slewed
  /// when the wall clock is disciplined (clock_gettime(2)), by chrony up to 8 %: do not compare another clock with it.
  [[nodiscard]] virtual std::int64_t raw_ns() const noexcept { return now_ns(); }
  /// Returns the total time for which the machine was suspended, ns; `now_ns` stops during that time.
  [[nodiscard]] virtual std::int64_t suspended_ns() const noexcept { return 0; }
  /// Returns wall clock minus `now_ns` at this moment, ns, to convert host times to UTC. Jumps when the wall clock is set.
  [[nodiscard]] virtual std::int64_t utc_minus_monotonic_ns() const noexcept;
};

/// The clocks of the machine.
class SystemClock final : public Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() const noexcept override;
  void sleep_until_ns(std::int64_t deadline_ns) noexcept override;
  [[nodiscard]] std::int64_t raw_ns() const noexcept override;
  [[nodiscard]] std::int64_t suspended_ns() const noexcept override;
};

/// Converts a time of `Clock::raw_ns` to a time of `Clock::now_ns`, with their difference at this moment. Realtime-safe: yes.
[[nodiscard]] std::int64_t monotonic_of_raw_ns(const Clock& clock, std::int64_t raw_ns) noexcept;

/// A clock that moves only when a thread sleeps on it or advances it: simulations and tests run as fast as the computer allows. It
/// never runs backwards, even if several threads sleep on it.
class VirtualClock final : public Clock {
 public:
  explicit VirtualClock(std::int64_t start_ns = 0) noexcept : now_ns_(start_ns) {}

  [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_ns_.load(std::memory_order_acquire); }
  void sleep_until_ns(std::int64_t deadline_ns) noexcept override {
    std::int64_t now = now_ns();
    while (now < deadline_ns && !now_ns_.compare_exchange_weak(now, deadline_ns, std::memory_order_acq_rel, std::memory_order_acquire)) {
    }  // pairs with now_ns()
  }
  [[nodiscard]] std::int64_t raw_ns() const noexcept override { return now_ns() - slewed_ns_.load(std::memory_order_acquire); }
  [[nodiscard]] std::int64_t suspended_ns() const noexcept override { return suspended_ns_.load(std::memory_order_acquire); }
  /// Shifts `now_ns` against `raw_ns` by `step_ns`, as a disciplined wall clock does.
  void slew_ns(std::int64_t step_ns) noexcept {
    slewed_ns_.fetch_add(step_ns, std::memory_order_acq_rel);  // pairs with raw_ns()
    if (step_ns > 0) advance_ns(step_ns);
  }
  /// Simulates a suspended machine: only `suspended_ns` increases.
  void suspend_ns(std::int64_t step_ns) noexcept {
    suspended_ns_.fetch_add(step_ns, std::memory_order_acq_rel);
  }  // pairs with suspended_ns()
  /// Advances the time; `step_ns` must not be negative.
  void advance_ns(std::int64_t step_ns) noexcept { now_ns_.fetch_add(step_ns, std::memory_order_acq_rel); }  // pairs with now_ns()

 private:
  std::atomic<std::int64_t> now_ns_;
  std::atomic<std::int64_t> slewed_ns_{0};
  std::atomic<std::int64_t> suspended_ns_{0};
};

}  // namespace dts::core
