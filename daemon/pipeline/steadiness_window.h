// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/units.h"
#include "pipeline/mailbox.h"

namespace dts::pipeline {

/// Measuring time of a trial.
struct SteadinessWindow {
  std::uint64_t number = 0;  ///< Increases with every window; 0: no window yet.
  std::uint32_t trial = 0;   ///< Position in the plan, from 1; 0: no trial, so the window is the last 30 s of standing.
  std::uint32_t segment = 0;
  core::ScanIndex first_scan;  ///< May be in the past: the window then begins immediately.
  core::ScanIndex end_scan;    ///< First scan after the window.
  bool is_restart = false;     ///< Begin a window without a trial again: a session begins.
};

/// Passes measuring windows of trials to the stage `steadiness`.
class SteadinessWindows : public Mailbox<SteadinessWindow> {
 public:
  /// Thread: control (the one writer). Realtime-safe: yes.
  void open(std::uint32_t trial, std::uint32_t segment, core::ScanIndex first_scan, core::ScanIndex end_scan) noexcept {
    send({.trial = trial, .segment = segment, .first_scan = first_scan, .end_scan = end_scan});
  }
  /// Ends the open window at `end_scan`, because the trial is over; the stage reaches this scan later than the control thread. Thread:
  /// control.
  void end_at(std::uint32_t segment, core::ScanIndex end_scan) noexcept {
    if (sent().trial == 0 || segment != sent().segment) return close();
    open(sent().trial, sent().segment, sent().first_scan, end_scan);
  }
  /// Ends the window immediately: no trial is measured. Thread: control.
  void close() noexcept {
    closed_ = sent();
    send({});
  }
  /// Ends every window immediately; without a trial, the next one begins at once. For the start of a session. Thread: control.
  void restart() noexcept { send({.is_restart = true}); }
  /// Continues the window that `close` ended last. Thread: control.
  void reopen() noexcept { send(closed_); }

 private:
  SteadinessWindow closed_;  ///< The window that `close` ended last.
};

}  // namespace dts::pipeline
