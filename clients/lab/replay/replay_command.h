// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command_line.h"

namespace dts::lab::replay {

/// Adds `dtslab replay`; its status is 0 if the recorded streams equal what the rig computes, 1 if not.
void add_commands(cli::CommandLine& line);

}  // namespace dts::lab::replay
