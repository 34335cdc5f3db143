// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ctl/command_tree.h"

namespace dts::ctl {

/// Adds `session`, `protocol` and `audit` with all their subcommands.
void add_sessions(CommandTree& tree);

}  // namespace dts::ctl
