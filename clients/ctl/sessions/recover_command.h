// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Copies what is whole of a recording that was never closed; the original stays as it is. Needs no daemon.
[[nodiscard]] int run_session_recover(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
