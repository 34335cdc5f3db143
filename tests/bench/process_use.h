// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <map>
#include <string>

namespace dts::bench {

/// What a running process has used so far, from /proc.
struct ObservedUse {
  double cpu_s = 0.0;                          ///< utime + stime of all its threads, in steps of 10 ms.
  std::map<std::string, double> thread_cpu_s;  ///< By thread name, to the nanosecond (schedstat).
  std::uint64_t context_switches = 0;          ///< Voluntary and involuntary, all threads.
  std::int64_t at_ns = 0;
};

[[nodiscard]] ObservedUse observe(pid_t pid);

/// Between two observations.
struct UseRate {
  double cpu_percent = 0.0;      ///< By utime + stime.
  double threads_percent = 0.0;  ///< Sum of the threads: the finer figure.
  std::map<std::string, double> thread_percent;
  double switches_per_s = 0.0;
};

[[nodiscard]] UseRate between(const ObservedUse& first, const ObservedUse& last);

}  // namespace dts::bench
