// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Runs `dtsctl calibrate cop`: tare, guided points, fit, file, verification. Returns the exit status.
[[nodiscard]] int run_calibrate_cop(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
