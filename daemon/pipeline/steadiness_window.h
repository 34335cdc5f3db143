// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/latest_value.h"
#include "core/units.h"

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

/// Passes measuring windows from the control thread, which runs the trials, to the stage `steadiness`. The stage reads a new window at its
/// next block, so a window set before its first scan is exact.
class SteadinessWindows {
 public:
  /// Thread: control (the one writer). Realtime-safe: yes.
  void open(std::uint32_t trial, std::uint32_t segment, core::ScanIndex first_scan, core::ScanIndex end_scan) noexcept {
    publish({.trial = trial, .segment = segment, .first_scan = first_scan, .end_scan = end_scan});
  }
  /// Ends the open window at `end_scan`, because the trial is over; the stage reaches this scan later than the control thread. Thread:
  /// control.
  void end_at(std::uint32_t segment, core::ScanIndex end_scan) noexcept {
    if (newest_.trial == 0 || segment != newest_.segment) return close();
    open(newest_.trial, newest_.segment, newest_.first_scan, end_scan);
  }
  /// Ends the window immediately: no trial is measured. Thread: control.
  void close() noexcept {
    closed_ = newest_;
    publish({});
  }
  /// Ends every window immediately; without a trial, the next one begins at once. For the start of a session. Thread: control.
  void restart() noexcept { publish({.is_restart = true}); }
  /// Opens the window again that `close` ended last. Thread: control.
  void reopen() noexcept { publish(closed_); }
  /// Returns the newest window. Thread: rig (the one reader). Realtime-safe: yes.
  [[nodiscard]] const SteadinessWindow& latest() noexcept { return box_.load(); }

 private:
  void publish(SteadinessWindow window) noexcept {
    window.number = newest_.number + 1;
    newest_ = window;
    box_.store(window);
  }

  SteadinessWindow newest_;
  SteadinessWindow closed_;  ///< The window that `close` ended last.
  core::LatestValue<SteadinessWindow> box_;
};

}  // namespace dts::pipeline
