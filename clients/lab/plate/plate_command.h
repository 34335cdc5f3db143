// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command_line.h"

namespace dts::lab::plate {

/// Adds `dtslab plate solve`.
void add_commands(cli::CommandLine& line);

}  // namespace dts::lab::plate
