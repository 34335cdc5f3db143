// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "lab/arguments.h"

namespace dts::lab {

/// `dtslab place`. Returns the exit status.
[[nodiscard]] int run_place(const Arguments& arguments, cli::Console& console);

}  // namespace dts::lab
