// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/console.h"

namespace dts::fleet::desk {

/// The program without signals and terminal: parses the words after its name, executes the command and returns the exit status.
[[nodiscard]] int run(const std::vector<std::string>& words, cli::Console& console);

}  // namespace dts::fleet::desk
