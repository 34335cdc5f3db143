// SPDX-License-Identifier: Apache-2.0
#include "core/thread.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <cerrno>
#include <cstring>

namespace dts::core {

std::vector<std::string> configure_this_thread(const std::string& name, const ThreadPolicy& policy) {
  std::vector<std::string> refused;
  constexpr std::size_t kMaxName = 15;  // kernel limit without the terminator
  pthread_setname_np(pthread_self(), name.substr(0, kMaxName).c_str());
  prctl(PR_SET_TIMERSLACK, 1UL);
  if (!policy.cpus.empty()) {
    cpu_set_t set;
    CPU_ZERO(&set);
    for (const int cpu : policy.cpus) {
      if (cpu >= 0 && cpu < CPU_SETSIZE) CPU_SET(static_cast<std::size_t>(cpu), &set);
    }
    if (const int error = pthread_setaffinity_np(pthread_self(), sizeof set, &set); error != 0) {
      refused.push_back("thread " + name + ": CPU affinity refused: " + std::strerror(error));
    }
  }
  if (policy.fifo_priority > 0) {
    const sched_param parameters{.sched_priority = policy.fifo_priority};
    if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters); error != 0) {
      refused.push_back("thread " + name + ": SCHED_FIFO refused: " + std::strerror(error) +
                        "; scans may arrive late under load (grant LimitRTPRIO or rtprio in limits.conf)");
    }
  }
  return refused;
}

Status lock_memory() {
  // MCL_ONFAULT: the default thread stacks alone would lock some 200 MB that nobody touches.
  if (mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) != 0) {
    return fail_errno(errno, "memory is not locked, pages may be swapped out", "grant LimitMEMLOCK=infinity or memlock in limits.conf");
  }
  return {};
}

}  // namespace dts::core
