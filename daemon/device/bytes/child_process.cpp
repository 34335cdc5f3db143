// SPDX-License-Identifier: Apache-2.0
#include "device/bytes/child_process.h"

#include <dirent.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

#include "device/bytes/spawn.h"

namespace dts::device::bytes {
namespace {

using core::ErrorCode;

constexpr std::array kFolders{"/usr/local/bin/", "/usr/bin/", "/bin/"};
constexpr const char* kPath = "PATH=/usr/local/bin:/usr/bin:/bin";
constexpr int kAskedMs = 100;
constexpr int kKilledMs = 100;
constexpr int kHuntRounds = 3;  // a process that forks while it is hunted is found in the next round

core::Descriptor open_pidfd(pid_t process) noexcept { return core::Descriptor(static_cast<int>(::syscall(SYS_pidfd_open, process, 0))); }

void send_signal(int pidfd, int signal) noexcept { static_cast<void>(::syscall(SYS_pidfd_send_signal, pidfd, signal, nullptr, 0)); }

bool is_readable(int descriptor, int limit_ms) noexcept {
  pollfd waiter{.fd = descriptor, .events = POLLIN, .revents = 0};
  return ::poll(&waiter, 1, limit_ms) > 0;
}

/// Returns the descriptor with a number above those of the standard streams, so that the child's dup2 cannot overwrite it.
core::Descriptor above_standard(core::Descriptor given) noexcept {
  if (given.get() < 0 || given.get() > STDERR_FILENO) return given;
  return core::Descriptor(::fcntl(given.get(), F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
}

void set_non_blocking(int descriptor) noexcept { ::fcntl(descriptor, F_SETFL, ::fcntl(descriptor, F_GETFL) | O_NONBLOCK); }

struct Pair {
  core::Descriptor ours;
  core::Descriptor childs;
};

Pair make_pipe() noexcept {
  std::array<int, 2> ends{-1, -1};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return {core::Descriptor(-1), core::Descriptor(-1)};
  return {above_standard(core::Descriptor(ends[0])), above_standard(core::Descriptor(ends[1]))};
}

/// A socket, not a pipe: writing to a child that has gone raises no SIGPIPE.
Pair make_socket() noexcept {
  std::array<int, 2> ends{-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return {core::Descriptor(-1), core::Descriptor(-1)};
  return {above_standard(core::Descriptor(ends[0])), above_standard(core::Descriptor(ends[1]))};
}

/// Returns an entry of the environment that only this child and what it starts have.
std::string make_mark() {
  static std::atomic<unsigned> count{0};
  return "DTSD_PROGRAM=" + std::to_string(::getpid()) + "-" + std::to_string(count.fetch_add(1, std::memory_order_relaxed));
}

std::string find_program(const std::string& name) {
  if (name.find('/') != std::string::npos) return name;
  for (const char* folder : kFolders) {
    if (::access((folder + name).c_str(), X_OK) == 0) return folder + name;
  }
  return {};
}

core::Error start_error(int system_errno, const std::string& program) {
  const std::string what = "cannot start the program " + program + ": " + std::strerror(system_errno);
  switch (system_errno) {
    case ENOENT: return {ErrorCode::NotFound, what, "check the path of the program, and the interpreter in its first line"};
    case EACCES:
    case EPERM:
      return {ErrorCode::NotAllowed, what, "make the file executable, in a folder that the service may read: not /home, not /tmp"};
    case ENOEXEC: return {ErrorCode::InvalidArgument, what, "add a first line that names the interpreter, for example #!/usr/bin/python3"};
    default: return {ErrorCode::Failed, what, {}};
  }
}

/// Looks into the first 4 KiB of the environment of a process; the program gets far less from us.
bool has_mark(const char* process, std::string_view mark) noexcept {
  std::array<char, 64> path{};
  std::array<char, 4096> text{};
  std::snprintf(path.data(), path.size(), "/proc/%.20s/environ", process);
  const core::Descriptor file(::open(path.data(), O_RDONLY | O_CLOEXEC));
  if (file.get() < 0) return false;
  const ssize_t count = ::read(file.get(), text.data(), text.size() - 1);
  if (count <= 0) return false;
  std::string_view left(text.data(), static_cast<std::size_t>(count));
  while (!left.empty()) {
    const std::size_t end = std::min(left.find('\0'), left.size());
    if (left.substr(0, end) == mark) return true;
    left.remove_prefix(std::min(end + 1, left.size()));
  }
  return false;
}

/// Kills every process that carries the mark. Returns true if there was one.
bool kill_marked(std::string_view mark) noexcept {
  DIR* const folder = ::opendir("/proc");
  if (folder == nullptr) return false;
  bool is_any = false;
  while (const dirent* entry = ::readdir(folder)) {
    const auto process = static_cast<pid_t>(std::strtol(entry->d_name, nullptr, 10));
    if (process <= 1) continue;
    const core::Descriptor pidfd = open_pidfd(process);  // before the look: the number cannot pass to another process in between
    if (pidfd.get() < 0 || !has_mark(entry->d_name, mark)) continue;
    send_signal(pidfd.get(), SIGKILL);
    is_any = true;
  }
  ::closedir(folder);
  return is_any;
}

}  // namespace

core::Result<ChildProcess> ChildProcess::start(const std::vector<std::string>& argv) {
  const std::string program = argv.empty() ? std::string{} : find_program(argv.front());
  if (program.empty()) {
    return core::fail(ErrorCode::NotFound,
                      "cannot start the program " + (argv.empty() ? "\"\"" : argv.front()) + ": it is not in " +
                          std::string(kPath).substr(sizeof "PATH=" - 1),
                      "write its whole path");
  }
  std::string mark = make_mark();
  std::vector<std::string> environment{mark, kPath};
  for (const char* name : {"LANG", "LC_ALL", "HOME"}) {
    if (const char* value = std::getenv(name); value != nullptr) environment.push_back(std::string(name) + "=" + value);
  }
  Pair input = make_socket();
  Pair output = make_pipe();
  Pair errors = make_pipe();
  Pair failure = make_pipe();
  for (const Pair* pair : {&input, &output, &errors, &failure}) {
    if (pair->ours.get() < 0 || pair->childs.get() < 0) return core::fail_errno(errno, "cannot make a pipe to the program " + program);
  }
  for (const Pair* pair : {&input, &output, &errors}) set_non_blocking(pair->ours.get());
  const pid_t child =
      spawn(program, argv, environment,
            {.input = input.childs.get(), .output = output.childs.get(), .errors = errors.childs.get(), .failure = failure.childs.get()});
  if (child < 0) return core::fail_errno(errno, "cannot start the program " + program);
  core::Descriptor pidfd = open_pidfd(child);
  if (pidfd.get() < 0) {
    const int error = errno;
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    return core::fail_errno(error, "cannot watch the program " + program);
  }
  { const core::Descriptor closed = std::move(failure.childs); }  // else the read below would wait for ourselves
  int child_errno = 0;
  if (::read(failure.ours.get(), &child_errno, sizeof child_errno) == sizeof child_errno) {
    ::waitpid(child, nullptr, 0);
    return tl::make_unexpected(start_error(child_errno, program));
  }
  return ChildProcess(child, std::move(mark), std::move(pidfd), std::move(input.ours), std::move(output.ours), std::move(errors.ours));
}

core::Descriptor ChildProcess::watch() const noexcept { return core::Descriptor(::fcntl(pidfd_.get(), F_DUPFD_CLOEXEC, 0)); }

bool ChildProcess::wait(int limit_ms) const noexcept { return is_reaped_ || is_readable(pidfd_.get(), limit_ms); }

std::string ChildProcess::end_text() const {
  siginfo_t end{};
  if (::waitid(P_PID, static_cast<id_t>(child_), &end, WEXITED | WNOHANG | WNOWAIT) != 0 || end.si_pid == 0) return {};
  if (end.si_code == CLD_EXITED) return "ended with exit status " + std::to_string(end.si_status);
  const char* const text = ::sigabbrev_np(end.si_status);
  return "was killed by signal " + std::to_string(end.si_status) + (text == nullptr ? std::string{} : std::string(" (SIG") + text + ")");
}

bool ChildProcess::end() noexcept {
  if (is_reaped_) return true;
  ::kill(-child_, SIGTERM);  // the number is ours until it is reaped
  static_cast<void>(wait(kAskedMs));
  ::kill(-child_, SIGKILL);
  for (int round = 0; round < kHuntRounds && kill_marked(mark_); ++round) {
  }
  if (!wait(kKilledMs)) return false;
  is_reaped_ = ::waitpid(child_, nullptr, WNOHANG) == child_ || errno == ECHILD;
  return is_reaped_;
}

}  // namespace dts::device::bytes
