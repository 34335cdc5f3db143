// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Writes pages about a session, or about any recording: one for the session, one for every trial. Replaces its own pages as a whole; never
/// changes another file of the same name.
[[nodiscard]] int run_report(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
