// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command_line.h"

namespace dts::ctl {

/// Returns the contents of dtsctl's manual page besides the commands.
[[nodiscard]] cli::Manual make_manual();

}  // namespace dts::ctl
