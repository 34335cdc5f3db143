// SPDX-License-Identifier: Apache-2.0
#include "core/thread.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/capability.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

#include "support/sanitized.h"

namespace dts::core {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr uid_t kNobody = 65534;
constexpr int kNoRights = 100;  // exit status, above all error codes

/// On a thread of its own: name, affinity and policy of the test's thread stay as they are.
void on_new_thread(const std::function<void()>& body) { std::thread(body).join(); }

std::string name_of_this_thread() {
  std::array<char, 16> name{};
  pthread_getname_np(pthread_self(), name.data(), name.size());
  return name.data();
}

int first_usable_cpu() {
  cpu_set_t set;
  CPU_ZERO(&set);
  sched_getaffinity(0, sizeof set, &set);
  int cpu = 0;
  while (cpu < CPU_SETSIZE - 1 && !CPU_ISSET(static_cast<std::size_t>(cpu), &set)) ++cpu;
  return cpu;
}

TEST(ConfigureThread, NoWishes_NamesItAndRefusesNothing_AndCutsALongName) {
  for (const auto& [name, known_as] :
       {std::pair<const char*, const char*>{"acquire", "acquire"}, {"a-name-longer-than-15-characters", "a-name-longer-t"}}) {
    on_new_thread([name = name, known_as = known_as] {
      EXPECT_THAT(configure_this_thread(name, {}), IsEmpty());
      EXPECT_EQ(name_of_this_thread(), known_as);
      EXPECT_EQ(prctl(PR_GET_TIMERSLACK), 1);
    });
  }
}

TEST(ConfigureThread, ExistingCpu_IsApplied) {
  const int cpu = first_usable_cpu();
  on_new_thread([cpu] {
    EXPECT_THAT(configure_this_thread("acquire", {.cpus = {cpu}}), IsEmpty());

    EXPECT_EQ(sched_getcpu(), cpu);
  });
}

TEST(ConfigureThread, OnlyMissingCpus_AreRefusedInOneSentence) {
  on_new_thread([] {
    const auto refused = configure_this_thread("acquire", {.cpus = {-1, CPU_SETSIZE, 1'000'000}});

    EXPECT_THAT(refused, ElementsAre("thread acquire: CPU affinity rejected: Invalid argument (this machine has " +
                                     std::to_string(std::thread::hardware_concurrency()) + " CPUs, numbered from 0)"));
  });
}

TEST(ConfigureThread, MissingCpuBesideExistingOne_IsNamed) {
  const int cpu = first_usable_cpu();
  on_new_thread([cpu] {
    const auto refused = configure_this_thread("acquire", {.cpus = {cpu, CPU_SETSIZE - 1, -3}});

    EXPECT_THAT(refused, ElementsAre("thread acquire: CPU 1023 rejected: it does not exist, or this process may not use it",
                                     "thread acquire: CPU -3 rejected: it does not exist, or this process may not use it"));
  });
}

TEST(ConfigureThread, PriorityOutOfRange_IsRefusedInOneSentence) {
  for (const int priority : {-1, 100}) {
    on_new_thread([priority] {
      const auto refused = configure_this_thread("pipeline", {.fifo_priority = priority});

      EXPECT_THAT(
          refused,
          ElementsAre("thread pipeline: SCHED_FIFO rejected: Invalid argument; scans may arrive late under load (priorities are 1 to "
                      "99; grant LimitRTPRIO or rtprio in limits.conf)"));
    });
  }
}

TEST(ConfigureThread, PriorityInRange_IsAppliedOrRefusedNeverSilent) {
  on_new_thread([] {
    const auto refused = configure_this_thread("pipeline", {.fifo_priority = 1});

    int policy = SCHED_OTHER;
    sched_param parameters{};
    pthread_getschedparam(pthread_self(), &policy, &parameters);
    EXPECT_EQ(policy == SCHED_FIFO, refused.empty());
    EXPECT_LE(refused.size(), 1U);
  });
}

TEST(ConfigureThread, TwoRefusals_AreTwoSentences) {
  on_new_thread([] { EXPECT_EQ(configure_this_thread("acquire", {.fifo_priority = 100, .cpus = {-1}}).size(), 2U); });
}

/// Runs `body` in a child process, whose memory may get locked; returns its exit status.
int in_child(const std::function<int()>& body) {
  const pid_t child = fork();
  if (child == 0) _exit(body());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Without the right to lock more than `limit_bytes`.
bool become_limited(rlim_t limit_bytes) {
  const rlimit limit{.rlim_cur = limit_bytes, .rlim_max = limit_bytes};
  return setrlimit(RLIMIT_MEMLOCK, &limit) == 0 && (geteuid() != 0 || setresuid(kNobody, kNobody, kNobody) == 0);
}

bool is_memory_locked() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmLck:")) return line.find_first_of("123456789") != std::string::npos;
  }
  return false;
}

TEST(LockMemory, LimitTooSmall_IsNotAllowed) {
  if (dts::test::kIsSanitized) GTEST_SKIP() << "sanitizers turn mlockall into a no-operation";
  constexpr rlim_t kTooSmall_bytes = 65'536;

  for (const rlim_t limit_bytes : {rlim_t{0}, kTooSmall_bytes}) {
    const int code = in_child([limit_bytes] {
      if (!become_limited(limit_bytes)) return kNoRights;
      const Status status = lock_memory();
      const bool is_why_said = !status && status.error().what.find("RLIMIT_MEMLOCK is finite") != std::string::npos;
      return is_why_said ? static_cast<int>(status.error().code) : 0;
    });
    EXPECT_EQ(code, static_cast<int>(ErrorCode::NotAllowed)) << limit_bytes << " bytes";
  }
}

/// As root in a container without CAP_IPC_LOCK.
bool drop_right_to_lock() {
  __user_cap_header_struct header{.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> sets{};
  if (syscall(SYS_capget, &header, sets.data()) != 0) return false;
  sets[CAP_TO_INDEX(CAP_IPC_LOCK)].effective &= ~CAP_TO_MASK(CAP_IPC_LOCK);
  return syscall(SYS_capset, &header, sets.data()) == 0;
}

TEST(LockableBytes, RootWithoutTheCapability_IsBoundByTheLimit) {
  if (dts::test::kIsSanitized) GTEST_SKIP() << "sanitizers turn mlock into a no-operation";
  constexpr rlim_t kLimit_bytes = 65'536;

  const int says_the_truth = in_child([] {
    const rlimit limit{.rlim_cur = kLimit_bytes, .rlim_max = kLimit_bytes};
    if (!drop_right_to_lock() || setrlimit(RLIMIT_MEMLOCK, &limit) != 0) return kNoRights;
    if (lockable_bytes() != kLimit_bytes || lock_memory().has_value()) return 0;
    rlimit after{};
    return getrlimit(RLIMIT_MEMLOCK, &after) == 0 && after.rlim_cur == kLimit_bytes ? 1 : 0;
  });

  EXPECT_EQ(says_the_truth, 1);
}

TEST(LockMemory, AsTheSystemAllows_SaysWhatHappened) {
  if (dts::test::kIsSanitized) GTEST_SKIP() << "sanitizers turn mlockall into a no-operation";

  const int says_the_truth = in_child([] { return lock_memory().has_value() == is_memory_locked() ? 1 : 0; });

  EXPECT_EQ(says_the_truth, 1);
}

}  // namespace
}  // namespace dts::core
