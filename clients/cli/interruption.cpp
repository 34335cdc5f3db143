// SPDX-License-Identifier: Apache-2.0
#include "cli/interruption.h"

#include <atomic>
#include <csignal>

namespace dts::cli {
namespace {

std::atomic<bool> is_interrupted = false;  // a signal handler writes it, on any thread
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void note_interruption(int /*signal*/) { is_interrupted.store(true); }

}  // namespace

Interruption::Interruption() {
  is_interrupted.store(false);
  before_ = std::signal(SIGINT, note_interruption);
}

Interruption::~Interruption() { std::signal(SIGINT, before_); }

bool Interruption::is_asked_for() const noexcept { return is_interrupted.load(); }

}  // namespace dts::cli
