// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lab/command_tree.h"

namespace dts::lab {

/// Adds `dtslab sway` and `dtslab steadiness ...`.
void add_sway(CommandTree& tree);

}  // namespace dts::lab
