// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/console.h"

namespace dts::gateway {

/// The program but for signals and the terminal: reads the words after its name, does what they say, returns the exit status.
[[nodiscard]] int run(const std::vector<std::string>& words, cli::Console& console);

}  // namespace dts::gateway
