// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command_line.h"

namespace dts::lab::thesis {

/// Adds `dtslab thesis`.
void add_commands(cli::CommandLine& line);

}  // namespace dts::lab::thesis
