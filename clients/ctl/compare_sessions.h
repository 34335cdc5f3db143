// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Prints results of several sessions side by side, with the difference to the first. Warns if values are not comparable, for example
/// because durations or profiles differ.
[[nodiscard]] int run_session_compare(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
