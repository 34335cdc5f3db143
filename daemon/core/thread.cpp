// SPDX-License-Identifier: Apache-2.0
#include "core/thread.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstring>
#include <limits>
#include <thread>

namespace dts::core {
namespace {

void restrict_to(const std::vector<int>& cpus, const std::string& name, std::vector<std::string>& rejected) {
  cpu_set_t wished;
  CPU_ZERO(&wished);
  for (const int cpu : cpus) {
    if (cpu >= 0 && cpu < CPU_SETSIZE) CPU_SET(static_cast<std::size_t>(cpu), &wished);
  }
  if (const int error = pthread_setaffinity_np(pthread_self(), sizeof wished, &wished); error != 0) {
    rejected.push_back("thread " + name + ": CPU affinity rejected: " + std::strerror(error) + " (this machine has " +
                       std::to_string(std::thread::hardware_concurrency()) + " CPUs, numbered from 0)");
    return;
  }
  // If the set has at least one usable CPU, the kernel accepts it and silently ignores the other CPUs.
  cpu_set_t granted;
  CPU_ZERO(&granted);
  pthread_getaffinity_np(pthread_self(), sizeof granted, &granted);
  for (const int cpu : cpus) {
    const bool is_granted = cpu >= 0 && cpu < CPU_SETSIZE && CPU_ISSET(static_cast<std::size_t>(cpu), &granted);
    if (!is_granted)
      rejected.push_back("thread " + name + ": CPU " + std::to_string(cpu) +
                         " rejected: it does not exist, or this process may not use it");
  }
}

}  // namespace

std::vector<std::string> configure_this_thread(const std::string& name, const ThreadPolicy& policy) {
  std::vector<std::string> rejected;
  constexpr std::size_t kMaxName = 15;  // kernel limit without the terminator
  pthread_setname_np(pthread_self(), name.substr(0, kMaxName).c_str());
  prctl(PR_SET_TIMERSLACK, 1UL);
  if (!policy.cpus.empty()) restrict_to(policy.cpus, name, rejected);
  if (policy.fifo_priority != 0) {
    const sched_param parameters{.sched_priority = policy.fifo_priority};
    if (const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters); error != 0) {
      rejected.push_back("thread " + name + ": SCHED_FIFO rejected: " + std::strerror(error) +
                         "; scans may arrive late under load (priorities are 1 to 99; grant LimitRTPRIO or rtprio in limits.conf)");
    }
  }
  return rejected;
}

std::uint64_t lockable_bytes() noexcept {
  constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();
  rlimit limit{};
  if (getrlimit(RLIMIT_MEMLOCK, &limit) != 0) return 0;
  if (limit.rlim_cur == RLIM_INFINITY) return kNoLimit;
  const rlimit nothing{.rlim_cur = 0, .rlim_max = limit.rlim_max};
  if (setrlimit(RLIMIT_MEMLOCK, &nothing) != 0) return limit.rlim_cur;
  constexpr std::size_t kOneByte = 1;  // the kernel rounds up to a page
  void* const page = mmap(nullptr, kOneByte, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  const bool is_bound = page == MAP_FAILED || mlock(page, kOneByte) != 0;
  if (page != MAP_FAILED) munmap(page, kOneByte);
  setrlimit(RLIMIT_MEMLOCK, &limit);
  return is_bound ? limit.rlim_cur : kNoLimit;
}

Status lock_memory() {
  // Under a finite limit the lock may succeed now, and every later allocation may fail: do not lock.
  if (lockable_bytes() != std::numeric_limits<std::uint64_t>::max()) {
    return fail(ErrorCode::NotAllowed, "memory is not locked, pages may be swapped out: RLIMIT_MEMLOCK is finite",
                "grant LimitMEMLOCK=infinity or memlock in limits.conf");
  }
  // MCL_ONFAULT: otherwise the default thread stacks alone would lock about 200 MB of unused memory.
  if (mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0) return {};
  const int error = errno;
  // mlock(2): EPERM if the limit is 0, ENOMEM if it is above 0 but too small.
  const ErrorCode code = error == EPERM || error == ENOMEM ? ErrorCode::NotAllowed : ErrorCode::Failed;
  return fail(code, std::string("memory is not locked, pages may be swapped out: ") + std::strerror(error),
              "grant LimitMEMLOCK=infinity or memlock in limits.conf");
}

}  // namespace dts::core
