// SPDX-License-Identifier: Apache-2.0
#include "cli/program.h"

#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <memory>
#include <string_view>

#include "cli/exit_status.h"
#include "cli/key_reader.h"

namespace dts::cli {
namespace {

/// Ends at once: every line is flushed when it is complete, so no output is lost.
extern "C" void on_interrupt(int /*signal*/) {
  KeyReader::restore();
  ::_exit(kInterrupted);
}

/// Leaves the terminal as it was, then does what the signal does by default.
extern "C" void on_end_or_stop(int number) {
  KeyReader::restore();
  std::signal(number, SIG_DFL);
  std::raise(number);
}

extern "C" void on_continue(int /*signal*/) { std::signal(SIGTSTP, on_end_or_stop); }

bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

bool has_reader_left() {
  pollfd item{.fd = STDOUT_FILENO, .events = 0, .revents = 0};
  return ::poll(&item, 1, 0) > 0 && (item.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
}

void measure_terminal(Console& console) {
  winsize size{};
  if (::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row == 0) return;
  console.columns = size.ws_col;
  console.lines = size.ws_row;
}

Console make_console(const std::string& name) {
  Console console{.out = std::cout, .talk = std::cerr, .program = name, .is_out_closed = has_reader_left};
  console.is_out_terminal = ::isatty(STDOUT_FILENO) == 1;
  console.is_talk_terminal = ::isatty(STDERR_FILENO) == 1;
  const char* terminal = std::getenv("TERM");
  const bool is_capable = console.is_out_terminal && terminal != nullptr && std::string_view(terminal) != "dumb";
  console.can_redraw = is_capable;
  console.has_colours = is_capable && !is_set("NO_COLOR");
  if (is_capable) console.is_quit_asked = [keys = std::make_shared<KeyReader>(STDIN_FILENO)] { return keys->is_pressed('q'); };
  console.measure = measure_terminal;
  console.measure(console);
  return console;
}

/// A reader that closes the pipe early ("dtsctl watch | head") is not a failure; a full disk is.
int check_output(const std::string& name, int status) {
  std::cout.flush();
  if (std::cout || has_reader_left()) return status;
  std::cerr << name << ": cannot write to standard output" << std::endl;
  return kFailed;
}

}  // namespace

int run_program(const std::string& name, int count, char** words,
                const std::function<int(const std::vector<std::string>&, Console&)>& run) {
  std::ios::sync_with_stdio(false);
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_end_or_stop);
  std::signal(SIGTSTP, on_end_or_stop);
  std::signal(SIGCONT, on_continue);
  std::signal(SIGPIPE, SIG_IGN);
  Console console = make_console(name);
  try {
    return check_output(name, run({words + 1, words + count}, console));
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << " (a bug: please report it)" << std::endl;
    return kFailed;
  }
}

}  // namespace dts::cli
