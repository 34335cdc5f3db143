// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Session commands that send one request to the daemon. Each returns the exit status.
[[nodiscard]] int run_session_start(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_session_stop(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_session_abort(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_session_resume(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_session_list(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_session_show(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_session_trial(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_protocol_list(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_protocol_show(const Arguments& arguments, cli::Console& console);
/// Fails with DataDamaged if the chain of the audit trail is broken; prints its entries anyway.
[[nodiscard]] int run_audit(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
