// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lab/command_tree.h"

namespace dts::lab {

/// Adds `dtslab reach ...`.
void add_reach(CommandTree& tree);

}  // namespace dts::lab
