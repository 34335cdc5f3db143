// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/latest_value.h"
#include "core/units.h"

namespace dts::pipeline {

/// Measuring time of a trial.
struct SteadinessWindow {
  std::uint64_t number = 0;  ///< Counts up with every window; 0: there has been none.
  std::uint32_t trial = 0;   ///< Place in the plan, from 1; 0: no trial, back to windows that begin when somebody steps on.
  std::uint32_t segment = 0;
  core::ScanIndex first_scan;  ///< May be in the past: the window then begins at once.
  core::ScanIndex end_scan;    ///< First that does not count.
};

/// The letter box between whoever runs trials and the stage `steadiness`. A window is taken up at the next block; told before its first
/// scan it is exact.
class SteadinessWindows {
 public:
  /// Thread: control (the one writer). Realtime-safe: yes.
  void open(std::uint32_t trial, std::uint32_t segment, core::ScanIndex first_scan, core::ScanIndex end_scan) noexcept {
    tell({.trial = trial, .segment = segment, .first_scan = first_scan, .end_scan = end_scan});
  }
  /// The trial is over: the open window goes on up to here, which the stage reaches later than the control thread. Thread: control.
  void end_at(std::uint32_t segment, core::ScanIndex end_scan) noexcept {
    if (told_.trial == 0 || segment != told_.segment) return close();
    open(told_.trial, told_.segment, told_.first_scan, end_scan);
  }
  /// No trial is measured any more, at once. Thread: control.
  void close() noexcept { tell({}); }
  /// The newest. Thread: pipeline (the one reader). Realtime-safe: yes.
  [[nodiscard]] const SteadinessWindow& latest() noexcept { return box_.load(); }

 private:
  void tell(SteadinessWindow window) noexcept {
    window.number = told_.number + 1;
    told_ = window;
    box_.store(window);
  }

  SteadinessWindow told_;
  core::LatestValue<SteadinessWindow> box_;
};

}  // namespace dts::pipeline
