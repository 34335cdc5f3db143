// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ctl/command_tree.h"
#include "ctl/console.h"

namespace dts::ctl {

/// Shows live data until `--count`, a closed output or a signal; `--timeout` bounds silence. Returns the exit status.
[[nodiscard]] int run_watch(const CommandTree& tree, Console& console);

}  // namespace dts::ctl
