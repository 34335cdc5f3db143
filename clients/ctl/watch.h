// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Shows live data until `--count` is reached, the output is closed or a signal arrives; `--timeout` limits silence. Returns the exit
/// status.
[[nodiscard]] int run_watch(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
