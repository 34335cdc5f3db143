// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "lab/arguments.h"

namespace dts::lab {

/// `dtslab reach study`. Returns the exit status.
[[nodiscard]] int run_reach_study(const Arguments& arguments, cli::Console& console);

}  // namespace dts::lab
