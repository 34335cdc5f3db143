// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "lab/arguments.h"

namespace dts::lab {

/// `dtslab replay`: returns 0 if the recorded streams equal what the rig computes, 1 if not.
[[nodiscard]] int run_replay(const Arguments& arguments, cli::Console& console);

}  // namespace dts::lab
