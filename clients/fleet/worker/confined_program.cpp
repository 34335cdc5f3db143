// SPDX-License-Identifier: Apache-2.0
#include "fleet/worker/confined_program.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/close_range.h>
#include <linux/filter.h>
#include <linux/sched.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

namespace dts::fleet::worker {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostTalk = 2000;
constexpr auto kLook = std::chrono::milliseconds(200);

class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    close();
    number_ = std::exchange(other.number_, -1);
    return *this;
  }
  void close() noexcept {
    if (number_ >= 0) ::close(number_);
    number_ = -1;
  }
  [[nodiscard]] int number() const noexcept { return number_; }

 private:
  int number_ = -1;
};

struct Pipe {
  Descriptor read;
  Descriptor write;
};

core::Result<Pipe> make_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return core::fail_errno(errno, "cannot make a pipe");
  return Pipe{Descriptor(ends[0]), Descriptor(ends[1])};
}

#if defined(__x86_64__)
constexpr std::uint32_t kMachine = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kMachine = AUDIT_ARCH_AARCH64;
#else
#error "the filter of system calls needs the number of this machine (linux/audit.h)"
#endif

/// Without sockets there is no way to the database or the network, without processes nothing outlives the program.
bool filter_system_calls() {
  constexpr std::uint32_t kNumber = offsetof(seccomp_data, nr);
  constexpr std::uint32_t kFirstArgument = offsetof(seccomp_data, args);  // the lower half on our little-endian machines
  const auto load = [](std::uint32_t offset) { return sock_filter BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offset); };
  const auto answer = [](std::uint32_t action) { return sock_filter BPF_STMT(BPF_RET | BPF_K, action); };
  const auto unless_equal_skip = [](std::uint32_t value, std::uint8_t count) {
    return sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, count);
  };
  std::vector<sock_filter> filter{load(offsetof(seccomp_data, arch)), unless_equal_skip(kMachine, 1),
                                  sock_filter BPF_JUMP(BPF_JMP | BPF_JA, 1, 0, 0), answer(SECCOMP_RET_KILL_PROCESS), load(kNumber)};
  // Numbers of the x32 ABI would pass the comparisons below.
  filter.push_back(sock_filter BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, 0x40000000U, 0, 1));
  filter.push_back(answer(SECCOMP_RET_KILL_PROCESS));
  for (const long number : {
#ifdef SYS_fork
           SYS_fork, SYS_vfork,
#endif
           SYS_socket, SYS_io_uring_setup, SYS_ptrace, SYS_process_vm_readv, SYS_process_vm_writev, SYS_pidfd_getfd, SYS_unshare, SYS_bpf,
           SYS_userfaultfd, SYS_keyctl}) {
    filter.push_back(unless_equal_skip(static_cast<std::uint32_t>(number), 1));
    filter.push_back(answer(SECCOMP_RET_ERRNO | EPERM));
  }
  // The flags of clone3 are not visible here; glibc then uses clone.
  filter.push_back(unless_equal_skip(SYS_clone3, 1));
  filter.push_back(answer(SECCOMP_RET_ERRNO | ENOSYS));
  filter.push_back(unless_equal_skip(SYS_clone, 3));
  filter.push_back(load(kFirstArgument));
  filter.push_back(sock_filter BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, CLONE_THREAD, 1, 0));
  filter.push_back(answer(SECCOMP_RET_ERRNO | EPERM));
  filter.push_back(answer(SECCOMP_RET_ALLOW));
  const sock_fprog program{.len = static_cast<unsigned short>(filter.size()), .filter = filter.data()};
  return ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

bool limit(__rlimit_resource resource, std::uint64_t most) {
  const rlimit both{.rlim_cur = most, .rlim_max = most};
  return ::setrlimit(resource, &both) == 0;
}

bool limit_resources(const Limits& limits) {
  return limit(RLIMIT_AS, limits.memory_bytes) && limit(RLIMIT_CPU, static_cast<std::uint64_t>(limits.time.count())) &&
         limit(RLIMIT_FSIZE, 0) && limit(RLIMIT_CORE, 0) && limit(RLIMIT_NOFILE, 64);
}

bool connect_streams(int out, int talk) {
  const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  return nothing >= 0 && ::dup2(nothing, STDIN_FILENO) >= 0 && ::dup2(out, STDOUT_FILENO) >= 0 && ::dup2(talk, STDERR_FILENO) >= 0 &&
         ::close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC) == 0;
}

bool reset_signals() {
  for (int number = 1; number < NSIG; ++number) ::signal(number, SIG_DFL);
  sigset_t none{};
  ::sigemptyset(&none);
  return ::sigprocmask(SIG_SETMASK, &none, nullptr) == 0;
}

/// In the new process. Writes errno to `problem` if the program cannot be started.
[[noreturn]] void become(const std::string& program, std::vector<char*>& words, const Limits& limits, pid_t parent, int out, int talk,
                         int problem) {
  std::array<char*, 4> environment{const_cast<char*>("LC_ALL=C.UTF-8"), const_cast<char*>("TZ=UTC"),
                                   const_cast<char*>("PATH=/usr/bin:/bin"), nullptr};
  const bool is_ready = ::setsid() >= 0 && reset_signals() && ::prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && ::getppid() == parent &&
                        connect_streams(out, talk) && ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && limit_resources(limits) &&
                        filter_system_calls();
  if (is_ready) ::execve(program.c_str(), words.data(), environment.data());
  const int error = errno;
  static_cast<void>(::write(problem, &error, sizeof error));
  ::_exit(127);
}

/// The child process. Its end is certain when this object has gone.
class Child {
 public:
  explicit Child(pid_t pid) : pid_(pid), watch_(static_cast<int>(::syscall(SYS_pidfd_open, pid, 0))) {}
  ~Child() { static_cast<void>(end()); }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  Child(Child&&) = delete;
  Child& operator=(Child&&) = delete;

  [[nodiscard]] int watch() const noexcept { return watch_.number(); }
  /// Returns true after the process has ended by itself.
  [[nodiscard]] bool has_ended() { return is_reaped_ || (is_reaped_ = ::waitpid(pid_, &status_, WNOHANG) == pid_); }
  /// Kills what is left of it. Returns the status as of waitpid.
  int end() {
    if (is_reaped_) return status_;
    ::kill(-pid_, SIGKILL);
    ::kill(pid_, SIGKILL);  // before setsid it has no group of its own
    while (::waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
    }
    is_reaped_ = true;
    return status_;
  }

 private:
  pid_t pid_;
  Descriptor watch_;
  int status_ = 0;
  bool is_reaped_ = false;
};

/// What the program prints, with its bounds.
class Output {
 public:
  Output(int out_end, int talk_end, std::size_t most_bytes) : ends_{out_end, talk_end}, most_bytes_(most_bytes) {
    for (const int end : ends_) ::fcntl(end, F_SETFL, O_NONBLOCK);
  }

  /// Waits until there is something to read, or the program has ended, but not long.
  void wait(int watch) {
    std::array<pollfd, 3> items{pollfd{.fd = is_open_[0] ? ends_[0] : -1, .events = POLLIN, .revents = 0},
                                pollfd{.fd = is_open_[1] ? ends_[1] : -1, .events = POLLIN, .revents = 0},
                                pollfd{.fd = watch, .events = POLLIN, .revents = 0}};
    static_cast<void>(::poll(items.data(), items.size(), static_cast<int>(kLook.count())));
  }
  /// Returns false after too much output.
  bool read_available() {
    std::array<char, 65536> bytes{};
    for (std::size_t stream = 0; stream < ends_.size(); ++stream) {
      // A few blocks at a time: a program that prints without end must not keep us from looking at the clock.
      for (int block = 0; is_open_[stream] && block < 64; ++block) {
        const auto count = ::read(ends_[stream], bytes.data(), bytes.size());
        if (count < 0) break;
        if (count == 0) is_open_[stream] = false;
        total_ += static_cast<std::size_t>(count);
        if (total_ > most_bytes_) return false;
        keep(stream, {bytes.data(), static_cast<std::size_t>(count)});
      }
    }
    return true;
  }

  std::string out{};
  std::string talk{};

 private:
  void keep(std::size_t stream, std::string_view bytes) {
    if (stream == 0) out += bytes;
    if (stream == 1) talk += bytes.substr(0, kMostTalk - std::min(kMostTalk, talk.size()));
  }

  std::array<int, 2> ends_;
  std::array<bool, 2> is_open_{true, true};
  std::size_t most_bytes_;
  std::size_t total_ = 0;
};

/// Returns the error of a process that could not become the program.
std::optional<int> start_problem(const Descriptor& problem) {
  int error = 0;
  return ::read(problem.number(), &error, sizeof error) == static_cast<ssize_t>(sizeof error) ? std::optional(error) : std::nullopt;
}

core::Result<Ended> ended(int status, Output& output) {
  if (WIFSIGNALED(status)) {
    const int number = WTERMSIG(status);
    return core::fail(core::ErrorCode::Failed, std::string("the program crashed: ") + ::strsignal(number) +
                                                   (number == SIGXCPU ? ": it needs more processor time than the limit" : ""));
  }
  return Ended{.out = std::move(output.out), .talk = std::move(output.talk), .status = WEXITSTATUS(status)};
}

}  // namespace

core::Result<Ended> run_confined(const std::string& program, const std::vector<std::string>& words, const Limits& limits,
                                 const std::function<bool()>& keeps_on) {
  DTS_TRY_ASSIGN(Pipe out, make_pipe());
  DTS_TRY_ASSIGN(Pipe talk, make_pipe());
  DTS_TRY_ASSIGN(Pipe problem, make_pipe());
  std::vector<std::string> texts{program};
  texts.insert(texts.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  for (std::string& text : texts) arguments.push_back(text.data());
  arguments.push_back(nullptr);
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid < 0) return core::fail_errno(errno, "cannot start '" + program + "'");
  if (pid == 0) become(program, arguments, limits, parent, out.write.number(), talk.write.number(), problem.write.number());
  Child child(pid);
  for (Pipe* const pipe : {&out, &talk, &problem}) pipe->write.close();
  if (const auto error = start_problem(problem.read)) {
    return core::fail_errno(*error, "cannot start '" + program + "'", "set 'dtslab' in the configuration to the path of dtslab");
  }
  Output output(out.read.number(), talk.read.number(), limits.output_bytes);
  const auto end = Clock::now() + limits.time;
  while (true) {
    output.wait(child.watch());
    const bool has_ended = child.has_ended();  // before reading: what is there after its end is all
    if (!output.read_available()) {
      return core::fail(core::ErrorCode::LimitExceeded, "the program printed more than " + std::to_string(limits.output_bytes) + " bytes");
    }
    if (has_ended) return ended(child.end(), output);
    if (Clock::now() >= end) {
      return core::fail(core::ErrorCode::Timeout, "the program did not end within " + std::to_string(limits.time.count()) + " s");
    }
    if (!keeps_on()) return core::fail(core::ErrorCode::WrongState, "the program was stopped");
  }
}

}  // namespace dts::fleet::worker
