// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command_line.h"

namespace dts::lab {

/// What dtslab's manual page says beyond its commands.
[[nodiscard]] cli::Manual make_manual();

}  // namespace dts::lab
