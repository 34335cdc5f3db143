// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "cli/command_line.h"

namespace dts::lab {

/// Returns the commands of dtslab; each room adds its own. The object must not move: its parts point to each other.
[[nodiscard]] std::unique_ptr<cli::CommandLine> make_command_tree();

}  // namespace dts::lab
