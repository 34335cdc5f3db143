// SPDX-License-Identifier: Apache-2.0
// A fake board as a program: fake_board OPTION=VALUE... speaks on stdin and stdout, or with pty=1 on a pseudo-terminal, whose name it
// prints.
#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>

#include "board/fd_board.h"
#include "core/clock.h"

namespace {

/// Opens a pseudo-terminal and prints its name. Returns -1 if there is none.
int open_port() {
  const int fd = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  if (fd < 0 || ::grantpt(fd) != 0 || ::unlockpt(fd) != 0) return -1;
  termios raw{};
  ::tcgetattr(fd, &raw);
  ::cfmakeraw(&raw);
  ::tcsetattr(fd, TCSANOW, &raw);
  std::printf("%s\n", ::ptsname(fd));
  std::fflush(stdout);
  return fd;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  dts::test::FakeBoardSetup setup;
  bool has_port = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    const std::size_t equals = argument.find('=');
    const std::string name(argument.substr(0, equals));
    const std::string value(equals == std::string_view::npos ? "" : argument.substr(equals + 1));
    if (name == "channels") {
      setup.channels = std::stoul(value);
    } else if (name == "rate_hz") {
      setup.rate = {static_cast<std::uint32_t>(std::stoul(value)), 1};
    } else if (name == "scans_per_frame") {
      setup.scans_per_frame = std::stoul(value);
    } else if (name == "lines") {
      setup.speaks_lines = value == "1";
    } else if (name == "counter") {
      setup.has_counter = value == "1";
    } else if (name == "pty") {
      has_port = value == "1";
    } else {
      std::fprintf(stderr, "fake_board: unknown argument %s\n", argv[i]);
      return 2;
    }
  }
  dts::core::SystemClock clock;
  dts::test::FakeBoard board(setup, clock.now_ns());
  dts::test::Damage damage;
  std::mutex mutex;
  const std::atomic<bool> must_stop{false};
  const int fd = has_port ? open_port() : -1;
  if (has_port && fd < 0) return 1;
  dts::test::run_board(board, has_port ? fd : 0, has_port ? fd : 1, damage, mutex, must_stop);
  return 0;
}
