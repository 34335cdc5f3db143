// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command_line.h"

namespace dts::lab {

/// Returns the sections of dtslab's manual page beyond its commands.
[[nodiscard]] cli::Manual make_manual();

}  // namespace dts::lab
