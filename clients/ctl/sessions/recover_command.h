// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Copies the complete part of a recording that was never closed; leaves the original unchanged. Needs no daemon.
[[nodiscard]] int run_session_recover(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
