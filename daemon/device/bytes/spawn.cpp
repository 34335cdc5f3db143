// SPDX-License-Identifier: Apache-2.0
#include "device/bytes/spawn.h"

#include <fcntl.h>
#include <linux/close_range.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/sysinfo.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string_view>

namespace dts::device::bytes {
namespace {

constexpr rlim_t kMostData = rlim_t{512} << 20;  // bytes of one process
constexpr rlim_t kMostFiles = 256;
constexpr rlim_t kMostNewProcesses = 64;
constexpr unsigned long kUsualTimerSlackNs = 50'000;  // the kernel's default; dtsd's threads have 1 ns
constexpr std::string_view kFirstToKill = "500";      // the kernel ends this program before dtsd if memory runs out

/// Everything that the child needs. Made before vfork: the child may neither allocate nor change memory.
struct Plan {
  const char* program;
  char* const* argv;
  char* const* environment;
  ChildEnds ends;
  pid_t parent;
  rlim_t processes;
};

[[noreturn]] void fail_in_child(const Plan& plan) noexcept {
  const int error = errno;
  [[maybe_unused]] const auto written = ::write(plan.ends.failure, &error, sizeof error);
  ::_exit(127);
}

void limit(__rlimit_resource resource, rlim_t value) noexcept {
  rlimit wanted{};
  if (::getrlimit(resource, &wanted) != 0) return;
  if (wanted.rlim_max < value) value = wanted.rlim_max;
  wanted = {.rlim_cur = value, .rlim_max = value};
  ::setrlimit(resource, &wanted);
}

void be_first_to_kill() noexcept {
  const int file = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  [[maybe_unused]] const auto written = ::write(file, kFirstToKill.data(), kFirstToKill.size());
}

/// Runs in the child. Calls only functions that change nothing in the shared memory, apart from errno.
[[noreturn]] void become_program(const Plan& plan) noexcept {
  if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || ::getppid() != plan.parent) fail_in_child(plan);
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1UL, 0UL, 0UL, 0UL) != 0) fail_in_child(plan);
  if (::setsid() < 0) fail_in_child(plan);
  const sched_param ordinary{};
  ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
  ::prctl(PR_SET_TIMERSLACK, kUsualTimerSlackNs);
  be_first_to_kill();
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_DATA, kMostData);
  limit(RLIMIT_MEMLOCK, 0);
  limit(RLIMIT_RTPRIO, 0);
  limit(RLIMIT_NOFILE, kMostFiles);
  limit(RLIMIT_NPROC, plan.processes);
  if (::dup2(plan.ends.input, STDIN_FILENO) < 0 || ::dup2(plan.ends.output, STDOUT_FILENO) < 0 ||
      ::dup2(plan.ends.errors, STDERR_FILENO) < 0)
    fail_in_child(plan);
  if (::syscall(SYS_close_range, STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC) != 0) fail_in_child(plan);
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  for (int signal = 1; signal < NSIG; ++signal) ::sigaction(signal, &usual, nullptr);  // fails for SIGKILL and SIGSTOP
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::execve(plan.program, plan.argv, plan.environment);
  fail_in_child(plan);
}

std::vector<char*> pointers_to(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));  // execve changes nothing
  pointers.push_back(nullptr);
  return pointers;
}

[[gnu::noinline]] pid_t vfork_program(const Plan& plan) noexcept {
  const pid_t child = ::vfork();
  if (child == 0) become_program(plan);
  return child;
}

}  // namespace

pid_t spawn(const std::string& program, const std::vector<std::string>& argv, const std::vector<std::string>& environment,
            const ChildEnds& ends) {
  const std::vector<char*> argument_pointers = pointers_to(argv);
  const std::vector<char*> environment_pointers = pointers_to(environment);
  struct sysinfo machine {};
  ::sysinfo(&machine);
  // The limit counts all processes of the user, who may have many: so it is above what the whole machine has now.
  const Plan plan{.program = program.c_str(),
                  .argv = argument_pointers.data(),
                  .environment = environment_pointers.data(),
                  .ends = ends,
                  .parent = ::getpid(),
                  .processes = machine.procs + kMostNewProcesses};
  // A signal handler must not run in the child: it would work in the parent's memory.
  sigset_t all;
  sigset_t before;
  ::sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t child = vfork_program(plan);
  const int error = errno;
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  errno = error;
  return child;
}

}  // namespace dts::device::bytes
