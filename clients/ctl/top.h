// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Shows the daemon's health at every status, about once a second, until `--count` is reached, the output is closed or a signal arrives.
/// Redraws in place on a terminal; otherwise prints one JSON object per line. Returns the exit status.
[[nodiscard]] int run_top(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
