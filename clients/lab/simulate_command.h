// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "lab/arguments.h"

namespace dts::lab {

/// `dtslab simulate`.
[[nodiscard]] int run_simulate(const Arguments& arguments, cli::Console& console);

}  // namespace dts::lab
