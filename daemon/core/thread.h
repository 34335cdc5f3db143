// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"

namespace dts::core {

/// Scheduling wishes of a thread. If the system rejects a wish, this is reported and the thread runs without it.
struct ThreadPolicy {
  int fifo_priority = 0;  ///< 1..99: SCHED_FIFO; 0: leave the default policy.
  std::vector<int> cpus;  ///< CPUs on which the thread may run; empty: all.
};

/// Names the calling thread (only the first 15 characters) and applies `policy`; returns one sentence per rejected wish.
/// Also sets the timer slack to 1 ns, which saves 48 us per tick without SCHED_FIFO (measured).
[[nodiscard]] std::vector<std::string> configure_this_thread(const std::string& name, const ThreadPolicy& policy);

/// Returns how many bytes this process may lock; the largest number means no limit. Tries it with a limit of 0, because neither the user ID
/// nor the capabilities show whether the kernel lets a process of a container exceed its limit. The limit is 0 only during the call: do
/// not call it while another thread locks memory.
[[nodiscard]] std::uint64_t lockable_bytes() noexcept;

/// Keeps all pages of the process in memory. Fails with NotAllowed if RLIMIT_MEMLOCK is too small.
[[nodiscard]] Status lock_memory();

}  // namespace dts::core
