// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command_line.h"

namespace dts::lab::resolution {

/// Adds `reach resolution` to the group `reach`.
void add_commands(cli::CommandLine& line, CLI::App& reach);

}  // namespace dts::lab::resolution
