// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Writes a session's recordings, all parts of them, as CSV or as a BIDS dataset. Nothing is overwritten; what is stopped leaves nothing.
[[nodiscard]] int run_session_export(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
