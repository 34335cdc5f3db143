// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/console.h"

namespace dts::lsl {

/// Runs dts-lsl with the words after the program's name; returns the exit status.
[[nodiscard]] int run(const std::vector<std::string>& words, cli::Console& console);

}  // namespace dts::lsl
