// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/console.h"

namespace dts::cli {

/// All of `main`: the process's signals, terminal and streams around `run`, which gets the words after the program's name.
/// Ctrl-C ends the process at once with 130; a reader that leaves early is no failure, output that cannot be written is.
[[nodiscard]] int run_program(const std::string& name, int count, char** words,
                              const std::function<int(const std::vector<std::string>&, Console&)>& run);

}  // namespace dts::cli
