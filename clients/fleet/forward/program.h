// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/console.h"

namespace dts::fleet::forward {

/// dts-forward without `main`: executes the command line and returns the exit status.
[[nodiscard]] int run(const std::vector<std::string>& words, cli::Console& console);

}  // namespace dts::fleet::forward
