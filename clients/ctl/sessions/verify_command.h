// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Reads every file of a session completely and compares it with its own checksums and those of the catalogue. An incomplete but sound
/// recording is not a failure, but its state is printed in capitals.
[[nodiscard]] int run_session_verify(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
