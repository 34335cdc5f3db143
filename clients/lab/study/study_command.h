// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command_line.h"

namespace dts::lab::study {

/// Adds `reach study` to the group `reach`.
void add_commands(cli::CommandLine& line, CLI::App& reach);

}  // namespace dts::lab::study
