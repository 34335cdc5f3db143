// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/console.h"
#include "dts/v1/control.pb.h"

namespace dts::ctl {

/// Print the daemon's answers for people, to `console.out`.
void print_status(cli::Console& console, const v1::StatusSnapshot& status);
void print_rigs(cli::Console& console, const v1::ListRigsResponse& rigs);
void print_rig(cli::Console& console, const v1::RigStatus& rig);
void print_devices(cli::Console& console, const v1::GetDevicesResponse& devices);
void print_device_test(cli::Console& console, const v1::TestDeviceResponse& test);

/// Returns true for a chair without a known zero: no reach on it can be classified. A replay contains its zero, and a rig's file may have
/// one.
[[nodiscard]] bool needs_tare(const v1::RigStatus& rig);
/// Returns the daemon's notices; a notice about several threads is one line: "threads publish, acq-floor: SCHED_FIFO rejected ...".
[[nodiscard]] std::vector<std::string> notice_lines(const v1::StatusSnapshot& status);
/// Returns "floor-7 running for 12.0 s of 25.0 s"; "-" if there was no session.
[[nodiscard]] std::string session_line(const v1::SessionInfo& session);
/// Returns "floor: zero is now at 0.012 -0.003 mm".
[[nodiscard]] std::string tare_line(const std::string& rig, const v1::TareResponse& tare);

}  // namespace dts::ctl
