// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/command_line.h"

namespace dts::lab::reach {

/// Adds the group `dtslab reach` with `reach events`; other rooms add the other commands of the group.
CLI::App& add_commands(cli::CommandLine& line);

/// Adds the argument DIR, which may be missing: a folder of trials.
CLI::Option* add_folder(CLI::App& command, std::string& folder);

}  // namespace dts::lab::reach
