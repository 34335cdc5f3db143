// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ctl/command_tree.h"

namespace dts::ctl {

/// Registers `dtsctl calibrate sensor` and `dtsctl calibrate cop`.
void add_calibrate(CommandTree& tree);

}  // namespace dts::ctl
