// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dts::core {

/// Wakes one waiting thread: an eventfd, so that it can also stand in a poll set beside sockets. Rings before the wait
/// are kept, several rings count as one. It carries no data: look into the ring after every wake-up.
class Doorbell {
 public:
  Doorbell();  ///< Throws std::system_error when the process has no descriptor left; construct on the control thread.
  ~Doorbell();
  Doorbell(const Doorbell&) = delete;
  Doorbell& operator=(const Doorbell&) = delete;

  /// Thread: any. Realtime-safe: yes (one write to an eventfd, never blocks).
  void ring() noexcept;
  /// Waits for a ring for at most `timeout_ms` (-1: for ever) and clears it; true when rung.
  /// Thread: the one waiter. Realtime-safe: yes (this is where a sample thread sleeps).
  bool wait(int timeout_ms) noexcept;
  /// Clears without waiting; for pollers that saw `fd()` readable.
  bool clear() noexcept;
  [[nodiscard]] int fd() const noexcept { return fd_; }

 private:
  int fd_ = -1;
};

}  // namespace dts::core
