// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"

namespace dts::core {

/// How a sample thread wants to be scheduled. Every part is a wish: what the system refuses is reported and done without.
struct ThreadPolicy {
  int fifo_priority = 0;  ///< 1..99: SCHED_FIFO; 0: leave the default policy.
  std::vector<int> cpus;  ///< Cores it may run on; empty: all.
};

/// Names the calling thread (at most 15 characters are kept) and applies `policy`; returns one sentence per refused wish.
/// Also sets the timer slack to 1 ns, which is worth 48 us per tick without SCHED_FIFO (measured).
[[nodiscard]] std::vector<std::string> configure_this_thread(const std::string& name, const ThreadPolicy& policy);

/// Returns how many bytes this process may lock; the largest number: no limit. Tries it, since no user ID and no set of capabilities says
/// whether the kernel lets a process of a container pass its limit; for that moment the limit is 0. Not while another thread locks memory.
[[nodiscard]] std::uint64_t lockable_bytes() noexcept;

/// Keeps all pages of the process in memory. Fails with NotAllowed when RLIMIT_MEMLOCK is too small.
[[nodiscard]] Status lock_memory();

}  // namespace dts::core
