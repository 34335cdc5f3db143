// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/console.h"

namespace dts::cli {

/// The whole `main`: sets up signals, terminal and streams, then calls `run` with the words after the program's name. Ctrl-C ends the
/// process at once with status 130. A reader that closes the output early is not a failure; output that cannot be written is.
[[nodiscard]] int run_program(const std::string& name, int count, char** words,
                              const std::function<int(const std::vector<std::string>&, Console&)>& run);

}  // namespace dts::cli
