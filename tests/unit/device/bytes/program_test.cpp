// SPDX-License-Identifier: Apache-2.0
#include "device/bytes/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <thread>

#include "support/temporary_folder.h"
#include "unit/device/bytes/link_ends.h"

namespace dts::device::bytes {
namespace {

using core::ErrorCode;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

struct ProgramTest : testing::Test {
  core::SystemClock clock;
  std::ostringstream lines;  ///< Read it only when the link is closed.
  core::Log log{std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(lines))};
  dts::test::TemporaryFolder folder;

  std::unique_ptr<ByteLink> program(std::vector<std::string> argv) { return run_program(std::move(argv), clock, log); }
  std::unique_ptr<ByteLink> shell(const std::string& script) { return program({"sh", "-c", script}); }
  std::unique_ptr<ByteLink> opened(const std::string& script) {
    auto link = shell(script);
    const auto opened = link->open();
    EXPECT_TRUE(opened.has_value()) << (opened ? "" : core::to_string(opened.error()));
    return link;
  }
  /// Returns everything that the script writes before it ends.
  std::string output_of(const std::string& script) {
    auto link = opened(script);
    ReadEnd end{};
    return read_text(*link, SIZE_MAX, end);
  }
};

bool is_alive(pid_t process) {
  if (::kill(process, 0) != 0) return false;
  std::ifstream status("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(status, text);
  return text.find(") Z ") == std::string::npos && !text.empty();  // an orphan's zombie waits for init
}

bool ends(pid_t process) {
  for (int i = 0; i < 3000 && is_alive(process); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return !is_alive(process);
}

bool has_children() { return ::waitpid(-1, nullptr, WNOHANG) != -1 || errno != ECHILD; }

TEST_F(ProgramTest, StdinAndStdoutAreTheLink) {
  auto link = opened("read line; echo \"heard $line\"; exec cat");
  ASSERT_TRUE(link->write(as_bytes("start\n")).has_value());
  EXPECT_EQ(read_text(*link, 12), "heard start\n");
  ASSERT_TRUE(link->write(as_bytes("again")).has_value());
  EXPECT_EQ(read_text(*link, 5), "again");
  EXPECT_EQ(link->why_lost(), "");
  link->close();
  EXPECT_FALSE(has_children());
}

TEST_F(ProgramTest, EndIsReportedWithStatusAndLastWords) {
  auto link = opened("echo data; echo one >&2; echo two >&2; echo 'no \033[2Jsensor' >&2; echo four >&2; exit 3");
  EXPECT_EQ(read_text(*link, 5), "data\n");
  EXPECT_EQ(read_to_end(*link), ReadEnd::Lost);
  EXPECT_EQ(link->why_lost(), "the program sh ended with exit status 3; its last words: two | no  [2Jsensor | four");
  link->close();
  EXPECT_THAT(link->why_lost(), HasSubstr("exit status 3")) << "known until the next open";
  ASSERT_TRUE(link->open().has_value());
  EXPECT_EQ(read_text(*link, 5), "data\n");
  link->close();
  EXPECT_THAT(lines.str(), HasSubstr("program sh: one"));
  EXPECT_FALSE(has_children());
}

TEST_F(ProgramTest, EndBySignalIsReported) {
  auto link = opened("kill -9 $$");
  EXPECT_EQ(read_to_end(*link), ReadEnd::Lost);
  EXPECT_EQ(link->why_lost(), "the program sh was killed by signal 9 (SIGKILL)");
}

TEST_F(ProgramTest, ClosedStdout_IsLost_ThoughTheProgramRuns) {
  auto link = opened("exec >&-; sleep 1000");
  EXPECT_EQ(read_to_end(*link), ReadEnd::Lost);
  EXPECT_EQ(link->why_lost(), "the program sh closed its standard output");
  link->close();
  EXPECT_FALSE(has_children());
}

TEST_F(ProgramTest, HangingProgram_ThatIgnoresSigterm_IsKilledWithItsGroup) {
  auto link = opened("trap '' TERM; sleep 1000 & echo $!; while :; do sleep 1000; done");
  const auto sleeper = static_cast<pid_t>(std::stol(read_text(*link, 2)));
  std::array<std::uint8_t, 8> buffer{};
  EXPECT_EQ(link->read(buffer, clock.now_ns() + 1'000'000).end, ReadEnd::Timeout);
  link->close();
  EXPECT_FALSE(has_children());
  EXPECT_TRUE(ends(sleeper));
}

TEST_F(ProgramTest, ProgramThatEndsOnSigterm_MayCleanUp) {
  const std::string note = folder.path() + "/note";
  auto link = shell("trap 'echo bye > " + note + "; exit 0' TERM; echo ready; while :; do sleep 0.01; done");
  for (int i = 0; i < 100 && !std::filesystem::exists(note); ++i) {  // a slow machine may not run it within its 100 ms
    ASSERT_TRUE(link->open().has_value());
    EXPECT_EQ(read_text(*link, 6), "ready\n");
    link->close();
  }
  EXPECT_TRUE(std::filesystem::exists(note));
}

TEST_F(ProgramTest, GrandchildInASessionOfItsOwn_IsKilledToo_AndDoesNotHoldTheLink) {
  auto link = opened("setsid sleep 1000 & echo $!; sleep 0.2; exit 0");
  const std::string text = read_text(*link, 2);
  EXPECT_EQ(read_to_end(*link), ReadEnd::Lost) << "the sleeper still has the pipe";
  EXPECT_EQ(link->why_lost().substr(0, 42), "the program sh ended with exit status 0");
  link->close();
  EXPECT_TRUE(ends(static_cast<pid_t>(std::stol(text))));
}

TEST_F(ProgramTest, Flood_IsReadWithoutEnd_AndEndsWithClose) {
  auto link = opened("exec cat /dev/zero");
  for (int i = 0; i < 100; ++i) EXPECT_GE(read_text(*link, 65536).size(), 65536U);
  link->close();
  EXPECT_FALSE(has_children());
}

TEST_F(ProgramTest, FloodOfErrors_StopsNeitherProgramNorLog) {
  auto link = opened(
      "head -c 100000000 /dev/zero | tr '\\0' '\\n' >&2; yes 'a word' | head -n 100000 >&2; head -c 10000000 /dev/zero >&2; echo done");
  EXPECT_EQ(read_text(*link, 5), "done\n");
  link->close();
  EXPECT_LT(lines.str().size(), 20'000U);
  EXPECT_THAT(lines.str(), HasSubstr("lines of its stderr were not logged"));
}

/// Returns the thread of this process that has the name, or 0. Waits until there is one.
pid_t thread_named(const std::string& name) {
  for (int i = 0; i < 3000; ++i, std::this_thread::sleep_for(std::chrono::milliseconds(10))) {
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
      std::string found;
      std::getline(std::ifstream(entry.path() / "comm") >> std::ws, found);
      if (found == name) return static_cast<pid_t>(std::stol(entry.path().filename()));
    }
  }
  return 0;
}

TEST_F(ProgramTest, ReaderOfErrors_IsNoRealTimeThread_ThoughTheOwnerIs) {
  const sched_param real_time{.sched_priority = 1};
  const sched_param ordinary{};
  if (::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &real_time) != 0) GTEST_SKIP() << "no right to SCHED_FIFO";
  auto link = opened("sleep 1000");
  EXPECT_EQ(::pthread_setschedparam(::pthread_self(), SCHED_OTHER, &ordinary), 0);
  const pid_t reader = thread_named("program-errors");
  ASSERT_GT(reader, 0);
  EXPECT_EQ(::sched_getscheduler(reader), SCHED_OTHER);
}

TEST_F(ProgramTest, FloodOfErrors_EveryLineIsLoggedOrCounted_AndTheLastWordsAreTheNewest) {
  auto link = opened("i=0; while [ $i -lt 20000 ]; do i=$((i+1)); echo \"line $i\"; echo; done >&2");
  EXPECT_EQ(read_to_end(*link), ReadEnd::Lost);
  EXPECT_THAT(link->why_lost(), HasSubstr("its last words: line 19998 | line 19999 | line 20000"));
  link->close();
  std::istringstream log_lines(lines.str());
  std::uint64_t logged = 0;
  std::uint64_t counted = 0;
  for (std::string line; std::getline(log_lines, line);) {
    std::smatch count;
    if (line.find("program sh: line ") != std::string::npos) ++logged;
    if (std::regex_search(line, count, std::regex("([0-9]+) (?:more )?lines of its stderr were not logged")))
      counted += std::stoull(count[1]);
  }
  EXPECT_EQ(logged + counted, 20'000U) << lines.str();
}

TEST_F(ProgramTest, WithoutFreeDescriptors_OpenFails_LeavesNoChild_AndWorksLater) {
  const int lowest_free = ::dup(STDOUT_FILENO);
  ASSERT_GE(lowest_free, 0);
  ::close(lowest_free);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  auto link = shell("echo x; sleep 1000");
  bool has_opened = false;
  for (rlim_t free = 0; free < 30; ++free) {
    const rlimit few{.rlim_cur = static_cast<rlim_t>(lowest_free) + free, .rlim_max = before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &few), 0);
    const auto opened = link->open();
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
    has_opened = opened.has_value();
    if (has_opened) break;
    EXPECT_FALSE(has_children()) << free << " free: " << core::to_string(opened.error());
    EXPECT_THAT(opened.error().what, Not(HasSubstr("has not ended yet")));
  }
  ASSERT_TRUE(has_opened);
  EXPECT_EQ(read_text(*link, 2), "x\n");
  link->close();
  EXPECT_FALSE(has_children());
}

TEST_F(ProgramTest, ReasonOfTheLoss_StaysTheFirst) {
  const std::string note = folder.path() + "/end";
  auto link = opened("echo $$; exec >&-; while [ ! -e " + note + " ]; do sleep 0.01; done; exit 3");
  const auto child = static_cast<pid_t>(std::stol(read_text(*link, 2)));
  EXPECT_EQ(read_to_end(*link), ReadEnd::Lost);
  const std::string first = link->why_lost();
  std::ofstream(note) << "end";
  EXPECT_TRUE(ends(child));
  EXPECT_EQ(link->why_lost(), first);
  link->close();
  EXPECT_EQ(link->why_lost(), first);
}

TEST_F(ProgramTest, WriteToAProgramThatHasEnded_FailsWithoutASignal) {
  auto link = opened("exit 0");
  EXPECT_EQ(read_to_end(*link), ReadEnd::Lost);
  const auto written = link->write(as_bytes("x"));
  ASSERT_FALSE(written.has_value());
  EXPECT_EQ(written.error().code, ErrorCode::DeviceGone);
}

TEST_F(ProgramTest, ProgramThatReadsNothing_WriteEndsWithTimeout) {
  auto link = opened("sleep 1000");
  const auto written = link->write(as_bytes(std::string(10'000'000, 'x')));
  ASSERT_FALSE(written.has_value());
  EXPECT_EQ(written.error().code, ErrorCode::Timeout);
}

TEST_F(ProgramTest, ProgramsThatCannotStart_AreExplained) {
  EXPECT_THAT(program({"no-such-program"})->open().error().what, HasSubstr("it is not in /usr/local/bin:/usr/bin:/bin"));
  EXPECT_EQ(program({"/no/such/program"})->open().error().code, ErrorCode::NotFound);
  const std::string file = folder.path() + "/script";
  std::ofstream(file) << "#!/bin/sh\n";
  EXPECT_EQ(program({file})->open().error().code, ErrorCode::NotAllowed);
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  EXPECT_TRUE(program({file})->open().has_value());
  std::ofstream(file) << "neither script nor program\n";
  EXPECT_EQ(program({file})->open().error().code, ErrorCode::InvalidArgument);
  EXPECT_FALSE(has_children());
}

TEST_F(ProgramTest, ChildHasNoDescriptorOfOurs) {
  const core::Descriptor leaked(::open("/dev/null", O_RDONLY));  // without O_CLOEXEC
  EXPECT_EQ(output_of("ls /proc/self/fd | head -n 3 | tr '\\n' ' '; ls -l /proc/$$/fd | grep -c null"), "0 1 2 0\n");
}

TEST_F(ProgramTest, ChildHasNoNewPrivileges_ItsOwnSession_AndOrdinaryScheduling) {
  const std::string status = output_of("cat /proc/self/status; ps -o sid=,pgid=,pid=,cls= -p $$ 2>/dev/null || true");
  EXPECT_THAT(status, HasSubstr("NoNewPrivs:\t1"));
  EXPECT_THAT(status, HasSubstr("SigBlk:\t0000000000000000"));
  EXPECT_THAT(status, HasSubstr("SigIgn:\t0000000000000000"));
  EXPECT_EQ(output_of("set -- $(cat /proc/$$/stat); [ $1 = $5 ] && [ $1 = $6 ] && echo leads"), "leads\n");
  EXPECT_EQ(output_of("cat /proc/self/oom_score_adj"), "500\n");
  EXPECT_EQ(output_of("set -- $(cat /proc/self/stat); shift 39; echo $1 $2"), "0 0\n") << "priority and policy";
}

TEST_F(ProgramTest, ChildHasLimits) {
  EXPECT_EQ(output_of("ulimit -c; ulimit -n"), "0\n256\n");
  EXPECT_EQ(output_of("ulimit -d"), "524288\n");
}

TEST_F(ProgramTest, EnvironmentIsReduced) {
  ::setenv("DTS_TEST_SECRET", "key", 1);
  const std::string environment = output_of("env");
  ::unsetenv("DTS_TEST_SECRET");
  EXPECT_THAT(environment, AllOf(HasSubstr("PATH=/usr/local/bin:/usr/bin:/bin\n"), HasSubstr("DTSD_PROGRAM="), Not(HasSubstr("SECRET"))));
}

TEST_F(ProgramTest, BlockedAndIgnoredSignalsOfOurs_AreDefaultInTheChild) {
  sigset_t blocked;
  sigset_t before;
  ::sigemptyset(&blocked);
  ::sigaddset(&blocked, SIGUSR1);
  ::pthread_sigmask(SIG_BLOCK, &blocked, &before);
  auto* const handler = ::signal(SIGPIPE, SIG_IGN);
  auto link = opened("kill -USR1 $$; echo lives");
  EXPECT_EQ(read_to_end(*link), ReadEnd::Lost);
  EXPECT_THAT(link->why_lost(), HasSubstr("SIGUSR1"));
  EXPECT_THAT(output_of("grep SigIgn /proc/self/status"), HasSubstr("0000000000000000"));
  ::signal(SIGPIPE, handler);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

TEST_F(ProgramTest, ForkBomb_EndsWithTheLink) {
  if (::geteuid() == 0) GTEST_SKIP() << "root has no limit of processes";
  auto link = opened("f() { f | f & }; f; echo bomb; sleep 1000");
  EXPECT_THAT(read_text(*link, 5), StartsWith("bomb"));
  link->close();
  EXPECT_FALSE(has_children());
}

TEST_F(ProgramTest, ChildEndsWithTheThreadThatStartedIt) {
  std::unique_ptr<ByteLink> link;
  std::thread([&] { link = opened("echo $$; exec sleep 1000"); }).join();
  EXPECT_EQ(read_to_end(*link), ReadEnd::Lost);
  EXPECT_THAT(link->why_lost(), HasSubstr("SIGKILL"));
}

TEST_F(ProgramTest, OpenAgain_StartsAnother_AndManyLeaveNoZombie) {
  auto link = shell("echo x; sleep 1000");
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(link->open().has_value());
    EXPECT_EQ(read_text(*link, 2), "x\n");
    link->close();
  }
  EXPECT_FALSE(has_children());
}

}  // namespace
}  // namespace dts::device::bytes
