// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "gateway/options.h"

namespace dts::gateway {

/// Runs the gateway until SIGINT, SIGTERM or SIGHUP, then ends within a second. Prints its address on `console.talk`. Returns the exit
/// status.
[[nodiscard]] int serve(const Options& options, cli::Console& console);

}  // namespace dts::gateway
