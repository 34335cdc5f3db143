// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/console.h"

namespace dts::lab {

/// Runs dtslab without signal handling and terminal setup: parses the command line (without the program's name), executes the command and
/// returns the exit status. Blocks until the command ends.
[[nodiscard]] int run(const std::vector<std::string>& arguments, cli::Console& console);

}  // namespace dts::lab
