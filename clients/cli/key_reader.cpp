// SPDX-License-Identifier: Apache-2.0
#include "cli/key_reader.h"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <string_view>

namespace dts::cli {
namespace {

// A signal handler reads both: the mode is written before the descriptor.
termios mode_before{};
std::atomic<int> changed_file = -1;
static_assert(std::atomic<int>::is_always_lock_free);

bool begin(int file) {
  if (::tcgetattr(file, &mode_before) != 0) return false;
  termios mode = mode_before;
  mode.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  mode.c_cc[VMIN] = 0;
  mode.c_cc[VTIME] = 0;
  changed_file.store(file);
  return ::tcsetattr(file, TCSANOW, &mode) == 0;
}

}  // namespace

bool KeyReader::is_pressed(char key) {
  // Not a terminal, or this program is in the background, where reading would stop it.
  if (::tcgetpgrp(file_) != ::getpgrp()) return false;
  if (changed_file.load() != file_ && !begin(file_)) return false;
  pollfd item{.fd = file_, .events = POLLIN, .revents = 0};
  std::array<char, 64> keys{};
  if (::poll(&item, 1, 0) <= 0 || (item.revents & POLLIN) == 0) return false;
  const ssize_t count = ::read(file_, keys.data(), keys.size());
  return count > 0 && std::string_view(keys.data(), static_cast<std::size_t>(count)).find(key) != std::string_view::npos;
}

void KeyReader::restore() noexcept {
  const int file = changed_file.exchange(-1);
  if (file >= 0) ::tcsetattr(file, TCSANOW, &mode_before);
}

}  // namespace dts::cli
