// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/console.h"
#include "ctl/arguments.h"
#include "ctl/system_facts.h"
#include "dts/endpoints.h"
#include "dts/v1/control.pb.h"

namespace dts::ctl {

/// The result of one check.
struct Check {
  std::string name;  ///< "floor rate"
  bool is_good = false;
  std::string finding;  ///< "100.02 of 100 Hz"
  std::string fix;      ///< What to do; for a good result, an optional improvement; empty: nothing.
};

/// Where the daemon runs; an address of a network can be that of this machine too.
enum class Daemon : std::uint8_t { Here, Elsewhere };

/// These functions build checks from collected facts; they send no requests and do not wait.
[[nodiscard]] Check check_version(const std::string& daemon_version);
[[nodiscard]] std::vector<Check> check_rig(const v1::RigStatus& rig);
/// Names the rig's calibration of the centre of pressure, its date, and the daemon's warning about it. Without one, returns a note for a
/// real floor rig, and nothing for others.
[[nodiscard]] std::optional<Check> check_calibration(const v1::StatusSnapshot& status, const v1::RigInfo& rig);
/// Returns a check for each of the daemon's warnings about the rig's sensor curves.
[[nodiscard]] std::vector<Check> check_sensor_curves(const v1::StatusSnapshot& status, const v1::RigInfo& rig);
/// Checks whether other machines can connect. `silent_relay`: the address at which dts-relay should listen and does not; empty: it does, or
/// this is not known.
[[nodiscard]] Check check_network(const v1::StatusSnapshot& status, const std::string& silent_relay);
/// Names the interrupted sessions.
[[nodiscard]] Check check_sessions(const v1::ListSessionsResponse& sessions);
/// Returns nothing if the daemon reports no disk.
[[nodiscard]] std::vector<Check> check_disk(const v1::DiskStatus& disk);
/// `status`: absent if the daemon did not answer. Otherwise it decides, because it shows what the daemon really has, whatever this user may
/// do.
[[nodiscard]] std::vector<Check> check_system(const SystemFacts& facts, const std::optional<v1::StatusSnapshot>& status,
                                              Daemon where = Daemon::Here);

/// Runs all checks. Returns exit status 0 if nothing is wrong, otherwise 1.
[[nodiscard]] int run_doctor(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
