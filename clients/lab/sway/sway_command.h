// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command_line.h"

namespace dts::lab::sway {

/// Adds `dtslab sway`: measures the steadiness of centres of pressure from files and recordings.
void add_commands(cli::CommandLine& line);

}  // namespace dts::lab::sway
