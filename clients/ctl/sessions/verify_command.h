// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Reads every file of a session whole, and compares it with its checksums and with the catalogue's. A recording that is incomplete but
/// sound is no failure, and says loudly what it is.
[[nodiscard]] int run_session_verify(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
