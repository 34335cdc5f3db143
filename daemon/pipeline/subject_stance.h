// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/latest_value.h"
#include "core/units.h"

namespace dts::pipeline {

/// What a session knows about how its subject stands.
struct SubjectStance {
  std::uint64_t number = 0;    ///< Increases with every change; 0: nothing is known.
  double width_mm = 0.0;       ///< Between the middle lines of the feet; 0: unknown.
  bool is_on_two_feet = true;  ///< false: a trial asks for one foot.
  std::uint32_t segment = 0;   ///< The stance is valid from this scan of the rig's raw stream on; immediately, if the scan has passed.
  core::ScanIndex first_scan{};
};

/// Passes the stance from the control thread, which runs the sessions, to the stage `cop`. The stage reads it at its next block, so a
/// stance set before its first scan is exact: a replay of the recording changes at the same scan.
class SubjectStances {
 public:
  /// Sets the stance of a session that begins, from the next block on: people stand on two feet unless a trial asks for one.
  /// Thread: control (the one writer). Realtime-safe: yes.
  void begin(double width_mm) noexcept { publish({.width_mm = width_mm}); }
  /// A trial asks for one foot or two, from a scan on. Thread: control.
  void change_feet(bool is_on_two_feet, std::uint32_t segment, core::ScanIndex first_scan) noexcept {
    if (is_on_two_feet == newest_.is_on_two_feet) return;
    publish({.width_mm = newest_.width_mm, .is_on_two_feet = is_on_two_feet, .segment = segment, .first_scan = first_scan});
  }
  /// Returns the newest stance. Thread: rig (the one reader). Realtime-safe: yes.
  [[nodiscard]] const SubjectStance& latest() noexcept { return box_.load(); }

 private:
  void publish(SubjectStance stance) noexcept {
    stance.number = newest_.number + 1;
    newest_ = stance;
    box_.store(stance);
  }

  SubjectStance newest_;
  core::LatestValue<SubjectStance> box_;
};

}  // namespace dts::pipeline
