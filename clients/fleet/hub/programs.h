// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command_line.h"
#include "cli/console.h"
#include "fleet/hub/settings.h"

namespace dts::fleet::hub {

/// The command lines of dts-hub and dts-fleet.
[[nodiscard]] std::shared_ptr<cli::CommandLine> make_hub_tree();
[[nodiscard]] std::shared_ptr<cli::CommandLine> make_fleet_tree();
/// Executes one of them; returns the exit status.
[[nodiscard]] int run_hub_program(const std::vector<std::string>& words, cli::Console& console);
[[nodiscard]] int run_fleet_program(const std::vector<std::string>& words, cli::Console& console);

/// Adds the option --config; `file` must outlive the command line.
void add_config_option(cli::CommandLine& line, std::string& file);
/// Reads the configuration; prints what is wrong with it and returns nothing.
[[nodiscard]] std::optional<Settings> settings_of(const std::string& file, cli::Console& console);
/// Returns "1 job", "2 jobs".
[[nodiscard]] inline std::string count_text(std::uint64_t count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

}  // namespace dts::fleet::hub
