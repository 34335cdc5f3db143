// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/command_line.h"
#include "cli/console.h"

namespace dts::cli {

/// A program without signals and terminal: parses the command line (without the program's name), executes the command and returns the exit
/// status. Blocks until the command ends. Call it only once per CommandLine.
[[nodiscard]] int run(CommandLine& line, const std::vector<std::string>& arguments, Console& console);

}  // namespace dts::cli
