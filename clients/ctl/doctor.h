// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/console.h"
#include "ctl/arguments.h"
#include "ctl/system_facts.h"
#include "dts/endpoints.h"
#include "dts/v1/control.pb.h"

namespace dts::ctl {

/// One thing looked at.
struct Check {
  std::string name;  ///< "floor rate"
  bool is_good = false;
  std::string finding;  ///< "100.02 of 100 Hz"
  std::string fix;      ///< What to do, or, when it is good, what would be better; empty: nothing.
};

/// Each makes checks from what was found out; nothing here asks or waits.
[[nodiscard]] Check check_version(const std::string& daemon_version);
[[nodiscard]] std::vector<Check> check_rig(const v1::RigStatus& rig);
/// Whether other machines can connect, and whether they did.
[[nodiscard]] Check check_network(const v1::StatusSnapshot& status);
/// Nothing when the daemon says nothing of a disk.
[[nodiscard]] std::vector<Check> check_disk(const v1::DiskStatus& disk);
/// `status`: absent when the daemon did not answer. When it did, it knows what it was given, whatever this user may do.
[[nodiscard]] std::vector<Check> check_system(const SystemFacts& facts, const std::optional<v1::StatusSnapshot>& status);

/// Runs all checks; exit status 0 when nothing is wrong, 1 otherwise.
[[nodiscard]] int run_doctor(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
