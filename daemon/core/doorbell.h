// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dts::core {

/// Wakes one waiting thread. Uses an eventfd, so a thread can poll it together with sockets. A ring before the wait is kept,
/// several rings count as one. It carries no data: check the SpscRing after every wake-up.
class Doorbell {
 public:
  Doorbell();  ///< Throws std::system_error if the process has no descriptor left; construct it on the control thread.
  ~Doorbell();
  Doorbell(const Doorbell&) = delete;
  Doorbell& operator=(const Doorbell&) = delete;

  /// Thread: any. Realtime-safe: yes (one write to an eventfd, never blocks).
  void ring() noexcept;
  /// Waits for a ring, at most `timeout_ms` (-1: no limit), and clears it; returns true if it was rung.
  /// Thread: the one waiter. Realtime-safe: yes (a thread with SCHED_FIFO may sleep here).
  bool wait(int timeout_ms) noexcept;
  /// Clears without waiting, for pollers that found `fd()` readable; returns true if it was rung.
  bool clear() noexcept;
  [[nodiscard]] int fd() const noexcept { return fd_; }

 private:
  int fd_ = -1;
};

}  // namespace dts::core
