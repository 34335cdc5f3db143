// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

namespace dts::core {

inline constexpr std::int64_t kNanosecondsPerMillisecond = 1'000'000;

/// Source of time, injected everywhere: no other file reads a system clock.
/// Thread: any. Realtime-safe: yes.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Monotonic time (CLOCK_MONOTONIC on Linux), ns.
  [[nodiscard]] virtual std::int64_t now_ns() const noexcept = 0;
  /// Returns at or after `deadline_ns` of the same time base.
  virtual void sleep_until_ns(std::int64_t deadline_ns) noexcept = 0;
};

/// The machine's CLOCK_MONOTONIC.
class SystemClock final : public Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() const noexcept override;
  void sleep_until_ns(std::int64_t deadline_ns) noexcept override;
};

/// Wall clock minus monotonic clock at this moment, ns: maps host times to UTC. Jumps when the wall clock is set.
[[nodiscard]] std::int64_t utc_minus_monotonic_ns() noexcept;

/// Time that passes only when somebody sleeps or advances it: simulations and tests run as fast as they compute. Like any
/// clock it never goes back, however many threads sleep on it.
class VirtualClock final : public Clock {
 public:
  explicit VirtualClock(std::int64_t start_ns = 0) noexcept : now_ns_(start_ns) {}

  [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_ns_.load(std::memory_order_acquire); }
  void sleep_until_ns(std::int64_t deadline_ns) noexcept override {
    std::int64_t now = now_ns();
    while (now < deadline_ns && !now_ns_.compare_exchange_weak(now, deadline_ns, std::memory_order_acq_rel, std::memory_order_acquire)) {
    }  // pairs with now_ns()
  }
  /// `step_ns` must not be negative.
  void advance_ns(std::int64_t step_ns) noexcept { now_ns_.fetch_add(step_ns, std::memory_order_acq_rel); }  // pairs with now_ns()

 private:
  std::atomic<std::int64_t> now_ns_;
};

}  // namespace dts::core
