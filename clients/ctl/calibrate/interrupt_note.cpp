// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/interrupt_note.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstddef>

#include "cli/exit_status.h"

namespace dts::ctl {
namespace {

std::array<char, 1024> note{};  // a signal handler must not allocate memory
volatile std::sig_atomic_t note_size = 0;

extern "C" void on_interrupt_with_note(int /*signal*/) {
  const ssize_t ignored = ::write(STDERR_FILENO, note.data(), static_cast<std::size_t>(note_size));
  static_cast<void>(ignored);
  ::_exit(cli::kInterrupted);
}

}  // namespace

InterruptNote::InterruptNote(const std::string& text) {
  const std::string line = "\n" + text + "\n";
  const std::size_t size = std::min(line.size(), note.size());
  std::copy_n(line.begin(), size, note.begin());
  note_size = static_cast<std::sig_atomic_t>(size);
  before_ = std::signal(SIGINT, on_interrupt_with_note);
}

InterruptNote::~InterruptNote() { std::signal(SIGINT, before_); }

}  // namespace dts::ctl
