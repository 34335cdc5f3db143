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
/// Processor time between SIGXCPU, which names the reason, and SIGKILL, which cannot be ignored.
constexpr std::uint64_t kGrace_s = 2;

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

/// System calls that are always rejected. Without sockets there is no way to the database or the network, without processes nothing
/// outlives the program. The rest could change files or processes of the worker's user: limits of descriptors and file sizes do not prevent
/// that.
constexpr std::array kRejected{
#ifdef SYS_fork
    SYS_fork, SYS_vfork,
#endif
    SYS_socket, SYS_socketpair, SYS_io_uring_setup, SYS_ptrace, SYS_process_vm_readv, SYS_process_vm_writev, SYS_pidfd_getfd, SYS_unshare,
    SYS_bpf, SYS_userfaultfd, SYS_keyctl, SYS_mq_open, SYS_mq_unlink, SYS_shmget, SYS_msgget, SYS_semget,
    // Other processes.
    SYS_tkill, SYS_rt_sigqueueinfo, SYS_rt_tgsigqueueinfo, SYS_pidfd_open, SYS_pidfd_send_signal, SYS_process_madvise, SYS_setpriority,
    SYS_ioprio_set, SYS_sched_setaffinity, SYS_sched_setscheduler, SYS_sched_setparam, SYS_sched_setattr, SYS_migrate_pages, SYS_move_pages,
    SYS_perf_event_open,
// Names and attributes of files.
#ifdef SYS_unlink
    SYS_unlink, SYS_rmdir, SYS_rename, SYS_link, SYS_symlink, SYS_mkdir, SYS_mknod, SYS_chmod, SYS_chown, SYS_lchown, SYS_creat, SYS_utime,
    SYS_utimes, SYS_futimesat,
#endif
#ifdef SYS_renameat
    SYS_renameat,
#endif
    SYS_unlinkat, SYS_renameat2, SYS_linkat, SYS_symlinkat, SYS_mkdirat, SYS_mknodat, SYS_truncate, SYS_ftruncate, SYS_fallocate,
    SYS_fchmod, SYS_fchmodat, 452 /* fchmodat2, Linux 6.6 */, SYS_fchown, SYS_fchownat, SYS_setxattr, SYS_lsetxattr, SYS_fsetxattr,
    SYS_removexattr, SYS_lremovexattr, SYS_fremovexattr, SYS_utimensat, SYS_open_by_handle_at, SYS_mount, SYS_umount2, SYS_chroot,
    SYS_pivot_root};

/// Rejects system calls of this process, for good. Allocates nothing: after a fork, another thread may have held the lock of the allocator.
class SystemCallFilter {
 public:
  SystemCallFilter() {
    load(offsetof(seccomp_data, arch));
    jump(BPF_JEQ, kMachine, 1, 0);
    answer(SECCOMP_RET_KILL_PROCESS);
    load(kNumber);
    // Numbers of the x32 ABI would pass the comparisons below.
    jump(BPF_JGE, 0x40000000U, 0, 1);
    answer(SECCOMP_RET_KILL_PROCESS);
  }
  void reject(long number, int error = EPERM) {
    jump(BPF_JEQ, static_cast<std::uint32_t>(number), 0, 1);
    answer(SECCOMP_RET_ERRNO | static_cast<std::uint32_t>(error));
  }
  /// Rejects the call if an argument is this value, is another one, has one of these bits, or has none of them.
  void reject_if_equal(long number, unsigned argument, std::uint32_t value) { reject_if(number, argument, BPF_JEQ, value, true); }
  void reject_if_other(long number, unsigned argument, std::uint32_t value) { reject_if(number, argument, BPF_JEQ, value, false); }
  void reject_if_any_bit(long number, unsigned argument, std::uint32_t bits) { reject_if(number, argument, BPF_JSET, bits, true); }
  void reject_if_no_bit(long number, unsigned argument, std::uint32_t bits) { reject_if(number, argument, BPF_JSET, bits, false); }
  [[nodiscard]] bool apply() {
    answer(SECCOMP_RET_ALLOW);
    if (length_ > filter_.size()) return false;
    const sock_fprog program{.len = static_cast<unsigned short>(length_), .filter = filter_.data()};
    return ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
  }

 private:
  static constexpr std::uint32_t kNumber = offsetof(seccomp_data, nr);
  static constexpr std::uint32_t kArguments = offsetof(seccomp_data, args);

  void add(const sock_filter& instruction) {
    if (length_ < filter_.size()) filter_[length_] = instruction;
    ++length_;
  }
  void load(std::uint32_t offset) { add(sock_filter BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offset)); }
  void jump(std::uint16_t comparison, std::uint32_t value, std::uint8_t skip_if_true, std::uint8_t skip_if_false) {
    add({static_cast<std::uint16_t>(BPF_JMP | BPF_K | comparison), skip_if_true, skip_if_false, value});
  }
  void answer(std::uint32_t action) { add(sock_filter BPF_STMT(BPF_RET | BPF_K, action)); }
  void reject_if(long number, unsigned argument, std::uint16_t comparison, std::uint32_t value, bool is_rejected_if_true) {
    jump(BPF_JEQ, static_cast<std::uint32_t>(number), 0, 4);
    load(kArguments + argument * 8U);  // the lower half on our little-endian machines; the kernel reads no more of an int
    jump(comparison, value, is_rejected_if_true ? 0 : 1, is_rejected_if_true ? 1 : 0);
    answer(SECCOMP_RET_ERRNO | EPERM);
    load(kNumber);
  }

  std::array<sock_filter, 512> filter_{};
  std::size_t length_ = 0;  ///< Of all that was added.
};

bool filter_system_calls() {
  constexpr std::uint32_t kWriting = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC;
  const auto own = static_cast<std::uint32_t>(::getpid());
  SystemCallFilter filter;
  for (const long number : kRejected) filter.reject(number);
  // Flags behind a pointer are not visible here; glibc then uses clone and openat.
  for (const long number : {SYS_clone3, SYS_openat2}) filter.reject(number, ENOSYS);
  filter.reject_if_no_bit(SYS_clone, 0, CLONE_THREAD);
#ifdef SYS_open
  filter.reject_if_any_bit(SYS_open, 1, kWriting);
#endif
  filter.reject_if_any_bit(SYS_openat, 2, kWriting);
  for (const long number : {SYS_kill, SYS_tgkill}) filter.reject_if_other(number, 0, own);
  filter.reject_if_other(SYS_prlimit64, 0, 0);
  // Signals to the owner of a descriptor.
  for (const int command : {F_SETOWN, F_SETOWN_EX, F_SETSIG}) filter.reject_if_equal(SYS_fcntl, 1, static_cast<std::uint32_t>(command));
  return filter.apply();
}

bool limit(__rlimit_resource resource, std::uint64_t most, std::uint64_t grace = 0) {
  const rlimit both{.rlim_cur = most, .rlim_max = most + grace};
  return ::setrlimit(resource, &both) == 0;
}

bool limit_resources(const Limits& limits) {
  return limit(RLIMIT_AS, limits.memory_bytes) && limit(RLIMIT_CPU, static_cast<std::uint64_t>(limits.time.count()), kGrace_s) &&
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

core::Result<Ended> ended(int status, Output& output, const Limits& limits) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) {
    return core::fail(core::ErrorCode::Timeout,
                      "the program needed more than " + std::to_string(limits.time.count()) + " s of processor time");
  }
  if (WIFSIGNALED(status)) {
    return core::fail(core::ErrorCode::Failed, std::string("the program crashed: ") + ::strsignal(WTERMSIG(status)));
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
    if (has_ended) return ended(child.end(), output, limits);
    if (Clock::now() >= end) {
      return core::fail(core::ErrorCode::Timeout, "the program did not end within " + std::to_string(limits.time.count()) + " s");
    }
    if (!keeps_on()) return core::fail(core::ErrorCode::WrongState, "the program was stopped");
  }
}

}  // namespace dts::fleet::worker
