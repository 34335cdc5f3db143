// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/units.h"
#include "pipeline/mailbox.h"

namespace dts::pipeline {

/// What a session knows about how its subject stands.
struct SubjectStance {
  std::uint64_t number = 0;    ///< Increases with every change; 0: nothing is known.
  double width_mm = 0.0;       ///< Between the middle lines of the feet; 0: unknown.
  bool is_on_two_feet = true;  ///< false: a trial asks for one foot.
  std::uint32_t segment = 0;   ///< The stance is valid from this scan of the rig's raw stream on; immediately, if the scan has passed.
  core::ScanIndex first_scan{};
};

/// Passes the stance to the stage `cop`. A replay of the recording changes it at the same scan.
class SubjectStances : public Mailbox<SubjectStance> {
 public:
  /// Sets the stance of a session that begins, from the next block on: people stand on two feet unless a trial asks for one.
  /// Thread: control (the one writer). Realtime-safe: yes.
  void begin(double width_mm) noexcept { send({.width_mm = width_mm}); }
  /// A trial asks for one foot or two, from a scan on. Thread: control.
  void change_feet(bool is_on_two_feet, std::uint32_t segment, core::ScanIndex first_scan) noexcept {
    if (is_on_two_feet == sent().is_on_two_feet) return;
    send({.width_mm = sent().width_mm, .is_on_two_feet = is_on_two_feet, .segment = segment, .first_scan = first_scan});
  }
};

}  // namespace dts::pipeline
