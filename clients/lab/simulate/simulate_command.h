// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command_line.h"

namespace dts::lab::simulate {

/// Adds `dtslab simulate`.
void add_commands(cli::CommandLine& line);

}  // namespace dts::lab::simulate
