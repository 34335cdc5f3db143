// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Writes pages about a session, or about any recording: one of the session, one of every trial. Pages of ours are replaced whole; a file
/// of the same name that is none is never touched.
[[nodiscard]] int run_report(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
