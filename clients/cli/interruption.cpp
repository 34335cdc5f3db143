// SPDX-License-Identifier: Apache-2.0
#include "cli/interruption.h"

#include <csignal>

namespace dts::cli {
namespace {

volatile std::sig_atomic_t is_interrupted = 0;  // all that a signal handler may touch

extern "C" void note_interruption(int /*signal*/) { is_interrupted = 1; }

}  // namespace

Interruption::Interruption() {
  is_interrupted = 0;
  before_ = std::signal(SIGINT, note_interruption);
}

Interruption::~Interruption() { std::signal(SIGINT, before_); }

bool Interruption::is_asked_for() const noexcept { return is_interrupted != 0; }

}  // namespace dts::cli
