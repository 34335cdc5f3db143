// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ctl/command_tree.h"

namespace dts::ctl {

/// `session`, `protocol` and `audit` with all that is below them.
void add_sessions(CommandTree& tree);

}  // namespace dts::ctl
