// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/latest_value.h"

namespace dts::pipeline {

/// Passes a `Letter` from the control thread, which runs the sessions, to one stage. The stage reads the newest letter at its next block,
/// so a letter that is sent before the first scan that it names is exact to the scan. `Letter` has a member `number`: it increases with
/// every letter, and 0 means that none was sent.
template <class Letter>
class Mailbox {
 public:
  /// Returns the newest letter. Thread: rig (the one reader). Realtime-safe: yes.
  [[nodiscard]] const Letter& latest() noexcept { return box_.load(); }

 protected:
  /// Thread: control (the one writer). Realtime-safe: yes.
  void send(Letter letter) noexcept {
    letter.number = sent_.number + 1;
    sent_ = letter;
    box_.store(letter);
  }
  /// Returns the letter that was sent last. Thread: control.
  [[nodiscard]] const Letter& sent() const noexcept { return sent_; }

 private:
  Letter sent_;
  core::LatestValue<Letter> box_;
};

}  // namespace dts::pipeline
