// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Runs `dtsctl calibrate sensor`: measures volts at known gaps or reads them from a file, checks them, and writes a file per sensor.
/// Returns the exit status.
[[nodiscard]] int run_calibrate_sensor(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
