// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "lab/arguments.h"

namespace dts::lab::reach {

/// `dtslab reach events`.
[[nodiscard]] int run_events(const Arguments& arguments, cli::Console& console);

}  // namespace dts::lab::reach
