// SPDX-License-Identifier: Apache-2.0
#include "fault/child_process.h"

#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <stdexcept>

namespace dts::fault {
namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void serve(const std::function<std::string()>& work, int output) {
  std::string text;
  try {
    text = work();
  } catch (const std::exception& error) {
    text = std::string("exception: ") + error.what();
  }
  std::string_view rest = text;
  while (!rest.empty()) {
    const ssize_t written = ::write(output, rest.data(), rest.size());
    if (written <= 0) ::_exit(2);
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
  ::_exit(0);
}

/// What the child says until it ends; nothing when it takes too long.
bool read_all(int input, Clock::time_point deadline, std::string& text) {
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd waiter{.fd = input, .events = POLLIN, .revents = 0};
    if (left <= 0 || ::poll(&waiter, 1, static_cast<int>(left)) == 0) return false;
    std::array<char, 4096> bytes{};
    const ssize_t count = ::read(input, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return true;
    text.append(bytes.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

std::string run_in_child(const std::function<std::string()>& work, std::chrono::seconds limit) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("no process");
  if (child == 0) {
    ::close(ends[0]);
    serve(work, ends[1]);
  }
  ::close(ends[1]);
  std::string text;
  const bool is_in_time = read_all(ends[0], Clock::now() + limit, text);
  ::close(ends[0]);
  if (!is_in_time) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!is_in_time) return "hangs: not done after " + std::to_string(limit.count()) + " s";
  if (WIFSIGNALED(status)) return "crashed with signal " + std::to_string(WTERMSIG(status));
  if (WEXITSTATUS(status) != 0) return "ended with status " + std::to_string(WEXITSTATUS(status));
  return text;
}

TemporaryFolder::TemporaryFolder(const std::string& parent)
    : path_((!parent.empty() && ::access(parent.c_str(), W_OK | X_OK) == 0 ? parent : "/tmp") + "/dts-fault-XXXXXX") {
  if (::mkdtemp(path_.data()) == nullptr) throw std::runtime_error("no temporary folder");
}
TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace dts::fault
