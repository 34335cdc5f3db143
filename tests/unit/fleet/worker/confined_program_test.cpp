// SPDX-License-Identifier: Apache-2.0
#include "fleet/worker/confined_program.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

#include "unit/fleet/worker/script_fixture.h"

namespace dts::fleet::worker {
namespace {

using ::testing::HasSubstr;

class ConfinedProgramTest : public ::testing::Test {
 protected:
  ~ConfinedProgramTest() override {
    errno = 0;
    EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a process is left";
    EXPECT_EQ(errno, ECHILD);
  }

  [[nodiscard]] core::Result<Ended> run_script(
      const std::string& text, const std::string& shell = "/bin/sh", const std::function<bool()>& keeps_on = [] { return true; }) const {
    return run_confined(write_script(folder_.path() + "/program", text, shell), {"first", "a b"}, limits_, keeps_on);
  }
  [[nodiscard]] core::ErrorCode code_of_script(const std::string& text) const {
    const auto ended = run_script(text);
    EXPECT_FALSE(ended);
    return ended ? core::ErrorCode::Internal : ended.error().code;
  }

  test::TemporaryFolder folder_{};
  Limits limits_{.time = std::chrono::seconds(60)};
};

TEST_F(ConfinedProgramTest, EndsWithItsOutputsAndStatus) {
  const auto ended = run_script("echo \"$1,$2\"; echo problem >&2; exit 7");
  ASSERT_TRUE(ended) << ended.error().what;
  EXPECT_EQ(ended->out, "first,a b\n");
  EXPECT_EQ(ended->talk, "problem\n");
  EXPECT_EQ(ended->status, 7);
}

TEST_F(ConfinedProgramTest, LongOutput_IsComplete) {
  const auto ended = run_script("exec head -c 3000000 /dev/zero");
  ASSERT_TRUE(ended) << ended.error().what;
  EXPECT_EQ(ended->out.size(), 3'000'000U);
}

TEST_F(ConfinedProgramTest, HasNoInput_NoEnvironment_AndNoDescriptorOfOurs) {
  ::setenv("PGPASSWORD", "secret", 1);
  const int open = ::fcntl(STDERR_FILENO, F_DUPFD, 100);  // without CLOEXEC
  const auto ended = run_script("read -r line && echo input; [ -e /proc/self/fd/" + std::to_string(open) + " ] && echo open; exec env");
  ::close(open);
  ::unsetenv("PGPASSWORD");
  ASSERT_TRUE(ended) << ended.error().what;
  EXPECT_THAT(ended->out, Not(HasSubstr("secret")));
  EXPECT_THAT(ended->out, Not(HasSubstr("input")));
  EXPECT_THAT(ended->out, Not(HasSubstr("open")));
  EXPECT_THAT(ended->out, HasSubstr("LC_ALL=C.UTF-8"));
}

TEST_F(ConfinedProgramTest, CannotWriteAFile) {
  const std::string file = folder_.path() + "/written";
  const auto ended = run_script("echo text > " + file);
  ASSERT_TRUE(ended) << ended.error().what;
  EXPECT_NE(ended->status, 0);
  EXPECT_FALSE(std::filesystem::exists(file));
}

/// Each line of the program tries one thing on a file and a folder of this user.
TEST_F(ConfinedProgramTest, CannotChangeAFile) {
  const std::string file = folder_.path() + "/recording";
  std::ofstream(file) << "whole";
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  const auto ended = run_script(R"(import os
def attempt(what, *words, **more):
  try:
    getattr(os, what)(*words, **more)
    print(what)
  except PermissionError:
    pass
file, other = ')" + file + R"(', ')" +
                                    file + R"(2'
attempt('open', file, os.O_RDONLY | os.O_TRUNC)
attempt('open', file, os.O_WRONLY)
attempt('open', other, os.O_RDONLY | os.O_CREAT)
attempt('unlink', file)
attempt('remove', 'recording', dir_fd=os.open(os.path.dirname(file), os.O_RDONLY))
attempt('rename', file, other)
attempt('truncate', file, 0)
attempt('link', file, other)
attempt('symlink', file, other)
attempt('mkdir', other)
attempt('mkfifo', other)
attempt('chmod', file, 0o777)
attempt('chown', file, os.getuid(), os.getgid())
attempt('utime', file)
attempt('setxattr', file, 'user.x', b'1')
print('end'))",
                                "/usr/bin/python3");
  ASSERT_TRUE(ended) << ended.error().what;
  EXPECT_EQ(ended->out, "end\n") << ended->talk;
  EXPECT_EQ(std::filesystem::file_size(file), 5U);
}

TEST_F(ConfinedProgramTest, CannotReachAnotherProcess) {
  const auto ended = run_script(R"(import os, resource, signal
def attempt(what, call):
  try:
    call()
    print(what)
  except PermissionError:
    pass
parent = os.getppid()
attempt('kill', lambda: os.kill(parent, 0))
attempt('kill group', lambda: os.kill(-1, 0))
attempt('killpg', lambda: os.killpg(os.getpgid(parent), 0))
attempt('pidfd', lambda: os.pidfd_open(parent))
attempt('prlimit', lambda: resource.prlimit(parent, resource.RLIMIT_CPU))
attempt('priority', lambda: os.setpriority(os.PRIO_PROCESS, parent, 19))
attempt('affinity', lambda: os.sched_setaffinity(parent, {0}))
import fcntl, socket
attempt('socketpair', socket.socketpair)  # its owner may be another process: FIOSETOWN, O_ASYNC
attempt('owner', lambda: fcntl.fcntl(0, fcntl.F_SETOWN, parent))
attempt('signal', lambda: fcntl.fcntl(0, fcntl.F_SETSIG, signal.SIGKILL))
os.kill(os.getpid(), 0)
resource.getrlimit(resource.RLIMIT_CPU)
print('end'))",
                                "/usr/bin/python3");
  ASSERT_TRUE(ended) << ended.error().what;
  EXPECT_EQ(ended->out, "end\n") << ended->talk;
}

TEST_F(ConfinedProgramTest, CannotStartAProcess) {
  const auto ended = run_script("(echo started)");
  ASSERT_TRUE(ended) << ended.error().what;
  EXPECT_EQ(ended->out, "");
  EXPECT_NE(ended->status, 0);
}

TEST_F(ConfinedProgramTest, CannotOpenASocket) {
  RecordProperty("requirement", "FLEET-5");
  const auto ended = run_script("exec 3<>/dev/tcp/127.0.0.1/9 || exit 5", "/bin/bash");
  ASSERT_TRUE(ended) << ended.error().what;
  EXPECT_THAT(ended->talk, HasSubstr("Operation not permitted"));
}

TEST_F(ConfinedProgramTest, CannotTakeMoreMemoryThanTheLimit) {
  RecordProperty("requirement", "FLEET-5");
  limits_.memory_bytes = 256 << 20;
  const auto ended =
      run_script("try:\n  bytearray(1 << 30)\n  print('taken')\nexcept MemoryError:\n  print('refused')", "/usr/bin/python3");
  ASSERT_TRUE(ended) << ended.error().what;
  EXPECT_EQ(ended->out, "refused\n");
}

TEST_F(ConfinedProgramTest, Crash_IsAFailure) {
  const auto ended = run_script("kill -SEGV $$");
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, core::ErrorCode::Failed);
  EXPECT_THAT(ended.error().what, HasSubstr("Segmentation fault"));
}

TEST_F(ConfinedProgramTest, ProgramThatHangs_IsKilled) {
  limits_.time = std::chrono::seconds(1);
  EXPECT_EQ(code_of_script("exec sleep 1000"), core::ErrorCode::Timeout);
  EXPECT_EQ(code_of_script("trap '' TERM HUP INT; exec >&- 2>&-; exec sleep 1000"), core::ErrorCode::Timeout);
}

TEST_F(ConfinedProgramTest, ProcessorTime_EndsWithItsReasonFirst) {
  const auto limits = run_script("ulimit -St; ulimit -Ht");
  ASSERT_TRUE(limits) << limits.error().what;
  EXPECT_EQ(limits->out, "60\n62\n");  // SIGXCPU, then SIGKILL
  const auto ended = run_script("kill -XCPU $$");
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, core::ErrorCode::Timeout);
  EXPECT_EQ(ended.error().what, "the program needed more than 60 s of processor time");
}

TEST_F(ConfinedProgramTest, ProgramThatPrintsWithoutEnd_IsKilled) {
  limits_.output_bytes = 1 << 20;
  EXPECT_EQ(code_of_script("exec head -c 1000000000 /dev/zero"), core::ErrorCode::LimitExceeded);
  EXPECT_EQ(code_of_script("exec head -c 1000000000 /dev/zero >&2"), core::ErrorCode::LimitExceeded);
}

TEST_F(ConfinedProgramTest, Caller_CanEndIt) {
  int calls = 0;
  const auto ended = run_script("exec sleep 1000", "/bin/sh", [&] { return ++calls < 3; });
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, core::ErrorCode::WrongState);
  EXPECT_EQ(calls, 3);
}

TEST_F(ConfinedProgramTest, ProgramThatDoesNotExist_IsNotFound) {
  const auto ended = run_confined(folder_.path() + "/none", {}, limits_, [] { return true; });
  ASSERT_FALSE(ended);
  EXPECT_EQ(ended.error().code, core::ErrorCode::NotFound);
  EXPECT_THAT(ended.error().what, HasSubstr("/none"));
}

}  // namespace
}  // namespace dts::fleet::worker
