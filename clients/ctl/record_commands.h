// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Commands that correct, delete and erase what was recorded. Each returns the exit status.
[[nodiscard]] int run_session_edit(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_session_delete(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_session_restore(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_subject_list(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_subject_show(const Arguments& arguments, cli::Console& console);
/// Asks on a terminal before it erases, unless `--yes` is given.
[[nodiscard]] int run_subject_erase(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
