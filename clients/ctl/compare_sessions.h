// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Figures of several sessions side by side, with the difference to the first. Values of other durations or profiles are not compared
/// silently: what differs is said.
[[nodiscard]] int run_session_compare(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
