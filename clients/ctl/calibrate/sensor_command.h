// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// `dtsctl calibrate sensor`: known gaps against volts, measured or from a file; checked; a file per sensor. Returns the exit status.
[[nodiscard]] int run_calibrate_sensor(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
