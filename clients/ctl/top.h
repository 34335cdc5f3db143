// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Shows the daemon's health with every status, that is once a second, until `--count`, a closed output or a signal: redrawn in place on a
/// terminal, else one JSON object per line. Returns the exit status.
[[nodiscard]] int run_top(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
