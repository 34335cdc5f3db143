// SPDX-License-Identifier: Apache-2.0
#include "cli/key_reader.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <string>

namespace dts::cli {
namespace {

bool has_mode(int terminal, tcflag_t flag) {
  termios mode{};
  return ::tcgetattr(terminal, &mode) == 0 && (mode.c_lflag & flag) != 0;
}

/// In a process of its own whose terminal is a pseudo terminal; returns 0, or the number of the expectation that failed.
int with_a_terminal(int (*act)(int keyboard, int terminal)) {
  const int keyboard = ::posix_openpt(O_RDWR | O_NOCTTY);
  EXPECT_TRUE(keyboard >= 0 && ::grantpt(keyboard) == 0 && ::unlockpt(keyboard) == 0);
  const std::string name = ::ptsname(keyboard);
  const pid_t child = ::fork();
  if (child == 0) {
    ::setsid();
    const int terminal = ::open(name.c_str(), O_RDWR);  // becomes the terminal of the new session
    ::_exit(terminal < 0 ? 99 : act(keyboard, terminal));
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  ::close(keyboard);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(KeyReader, OnATerminal_ReadsKeysWithoutEnterAndRestoresIt) {
  EXPECT_EQ(with_a_terminal([](int keyboard, int terminal) {
              if (!has_mode(terminal, ICANON)) return 1;
              {
                KeyReader keys(terminal);
                if (!has_mode(terminal, ECHO)) return 2;  // unchanged until it is asked
                if (keys.is_pressed('q')) return 3;
                if (has_mode(terminal, ICANON) || has_mode(terminal, ECHO) || !has_mode(terminal, ISIG)) return 4;
                if (::write(keyboard, "xyz", 3) != 3 || keys.is_pressed('q')) return 5;
                if (::write(keyboard, "aq", 2) != 2 || !keys.is_pressed('q')) return 6;
                if (keys.is_pressed('q')) return 7;
                KeyReader::restore();  // as the handler of Ctrl-Z does
                if (!has_mode(terminal, ICANON) || !has_mode(terminal, ECHO)) return 9;
                if (keys.is_pressed('q') || has_mode(terminal, ICANON)) return 10;  // continued
              }
              return has_mode(terminal, ICANON) && has_mode(terminal, ECHO) ? 0 : 8;
            }),
            0);
}

TEST(KeyReader, WithoutATerminal_ReadsNothing) {
  int pipe[2] = {};
  ASSERT_EQ(::pipe(pipe), 0);
  ASSERT_EQ(::write(pipe[1], "q", 1), 1);
  KeyReader keys(pipe[0]);
  EXPECT_FALSE(keys.is_pressed('q')) << "the pipe may be the input of another program";
  char left = 0;
  EXPECT_EQ(::read(pipe[0], &left, 1), 1);
  ::close(pipe[0]);
  ::close(pipe[1]);
}

}  // namespace
}  // namespace dts::cli
