// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command_line.h"

namespace dts::lab::force {

/// Adds `dtslab force` and `dtslab grf`.
void add_commands(cli::CommandLine& line);

void add_force(cli::CommandLine& line);
void add_grf(cli::CommandLine& line);

}  // namespace dts::lab::force
