// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace dts::ctl {

/// What this machine allows this user, as far as latency depends on it.
struct SystemFacts {
  bool may_use_fifo = false;         ///< A thread of this user was allowed to become SCHED_FIFO.
  std::uint64_t lockable_bytes = 0;  ///< The largest number: no limit.
  std::string clock_source;          ///< "tsc"; empty when unknown.
};

[[nodiscard]] SystemFacts gather_system_facts();

}  // namespace dts::ctl
