// SPDX-License-Identifier: Apache-2.0
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <utility>

#include "cli/interruption.h"
#include "cli/try.h"
#include "gateway/access/password.h"
#include "gateway/access/user_commands.h"

namespace dts::gateway {
namespace {

using client::ErrorCode;
using client::Result;

/// Switches the echo off while it lives. Ctrl-C waits until the echo is on again.
class Silence {
 public:
  explicit Silence(int descriptor) : descriptor_(descriptor) {
    if (::tcgetattr(descriptor_, &before_) != 0) return;
    termios silent = before_;
    silent.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    silent.c_lflag |= static_cast<tcflag_t>(ECHONL);
    is_silent_ = ::tcsetattr(descriptor_, TCSAFLUSH, &silent) == 0;
  }
  ~Silence() {
    if (is_silent_) ::tcsetattr(descriptor_, TCSAFLUSH, &before_);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

  [[nodiscard]] explicit operator bool() const noexcept { return is_silent_; }
  [[nodiscard]] bool is_interrupted() const noexcept { return interruption_.is_asked_for(); }

 private:
  cli::Interruption interruption_;
  int descriptor_;
  termios before_{};
  bool is_silent_ = false;
};

constexpr int kLookEvery_ms = 100;

/// Reads one letter at a time, so that no other buffer holds parts of the password.
Result<Secret> read_line(int descriptor, const std::function<bool()>& is_interrupted) {
  std::string line;
  line.reserve(kMostPasswordBytes + 2);  // never reallocates, so it leaves no copy behind
  while (true) {
    // A blocking read would not notice Ctrl-C.
    pollfd input{.fd = descriptor, .events = POLLIN, .revents = 0};
    if (::poll(&input, 1, kLookEvery_ms) <= 0 && !is_interrupted()) continue;
    if (is_interrupted()) {
      wipe(line);
      return client::fail(ErrorCode::Failed, "interrupted: nothing is changed");
    }
    char letter = 0;
    const ssize_t got = ::read(descriptor, &letter, 1);
    if (got <= 0 && line.empty()) return client::fail(ErrorCode::InvalidArgument, "no password was given");
    if (got <= 0 || letter == '\n') return Secret(std::move(line));
    line += letter;
    if (line.size() > kMostPasswordBytes) return Secret(std::move(line));  // long enough to be rejected
  }
}

}  // namespace

Result<Secret> ask_password(int descriptor, cli::Console& console) {
  if (::isatty(descriptor) == 0) return read_line(descriptor, [] { return false; });
  const Silence silence(descriptor);
  if (!silence) return client::fail(ErrorCode::Failed, "cannot hide the password on this terminal");
  const auto is_interrupted = [&silence] { return silence.is_interrupted(); };
  console.talk << "Password: " << std::flush;
  DTS_TRY_ASSIGN(auto password, read_line(descriptor, is_interrupted));
  console.talk << "Again: " << std::flush;
  DTS_TRY_ASSIGN(const auto again, read_line(descriptor, is_interrupted));
  if (again.text() == password.text()) return password;
  return client::fail(ErrorCode::InvalidArgument, "the two passwords differ");
}

}  // namespace dts::gateway
