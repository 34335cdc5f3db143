// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/command_line.h"
#include "cli/console.h"

namespace dts::cli {

/// A program but for signals and the terminal: reads the command line (without the program's name), executes the command and
/// returns the exit status. Blocks as long as the command does. Once per CommandLine.
[[nodiscard]] int run(CommandLine& line, const std::vector<std::string>& arguments, Console& console);

}  // namespace dts::cli
