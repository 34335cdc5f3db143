// SPDX-License-Identifier: Apache-2.0
#include "core/process.h"

#include <signal.h>
#include <sys/resource.h>

namespace dts::core {

void block_signals(std::initializer_list<int> signals) noexcept {
  sigset_t ours;
  sigemptyset(&ours);
  for (const int signal : signals) sigaddset(&ours, signal);
  pthread_sigmask(SIG_BLOCK, &ours, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGCHLD, SIG_DFL);  // inherited if the parent ignores it: the status of a child would then be lost
}

void raise_descriptor_limit() noexcept {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace dts::core
